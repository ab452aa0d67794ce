// A .vox file: what opens can be looked up anywhere, audited, and felt by a part, without a fault.
#include "formats/voxmap.h"

#include "forcelayer/run.h"
#include "formats/audit/voxmap_audit.h"
#include "runtime/model/simulation.h"
#include "tests/fuzz/baked_mutator.h"
#include "tests/fuzz/work.h"
#include "tests/support/aligned_bytes.h"
#include "tests/support/make_pshell.h"
#include "tests/support/point_part.h"
#include "tests/support/random_scenes.h"

namespace forcelayer::fuzz {
namespace {

using namespace forcelayer::test;

// Baked files take 1 block a byte to open and 212 to audit. An audit gives up at some 10^5 looks (a
// thousand blocks each, or a few) whatever the file's size, and some for each byte.
constexpr WorkBound kOpening{10'000, 20}, kAudit{1'000'000'000, 20'000};

void look_up(const Voxmap& map, Random& random) {
  const auto& origin = map.view().directory_origin;
  for (int n = 0; n < 64; ++n) {
    std::array<std::int64_t, 3> voxel{};
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t span = std::int64_t{map.view().directory_dims[axis]} * kUpperNodeEdge;
      voxel[axis] = origin[axis] - 8 + static_cast<std::int64_t>(random() % (span + 16));
    }
    require(static_cast<unsigned>(map.value(voxel[0], voxel[1], voxel[2])) < 4, "four values");
    require(map.min_distance_m(voxel[0], voxel[1], voxel[2]) <
                map.max_distance_m(voxel[0], voxel[1], voxel[2]),
            "a code's step");
    (void)map.object_name(map.nearest_object(voxel[0], voxel[1], voxel[2]));
  }
}

// A few frames of a small part about the middle of the map, under a model with the force that it
// has there.
void feel(Voxmap map, Model model, Random& random) {
  const double s = map.voxel_size_m();
  RunRequest request;
  request.model = model;
  request.without_guarantee = true;
  glm::dvec3 middle_m;
  for (int axis = 0; axis < 3; ++axis) {
    middle_m[axis] = s * (static_cast<double>(map.header().origin_voxel[axis]) +
                          0.5 * static_cast<double>(map.header().dims_voxels[axis]));
  }
  auto run = open_run(std::move(map), make_pshell(sphere_part(4 * s, 60, s)), request);
  if (!run) return;
  model::Simulation& simulation = run->simulation();
  const Pose start{middle_m, random_orientation(random)};
  State state = simulation.registered(start, start);
  for (int frame = 0; frame < 8; ++frame) {
    StepInput input;
    input.world_from_handle = start;
    input.world_from_handle.position_m += random_direction(random) * (20 * s);
    input.valid = 1;
    const StepResult result = simulation.step(state, input, 0.001);
    require(std::isfinite(result.wrench.force_n.x), "a finite force");
  }
}

}  // namespace
}  // namespace forcelayer::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcelayer;
  const testing::AlignedBytes bytes(fuzz::bytes_of(data, size));
  for (const Verify verify : {Verify::kStructureAndChecksums, Verify::kStructure}) {
    const bool checked = verify == Verify::kStructureAndChecksums;
    auto map = fuzz::within(fuzz::kOpening, size,
                            [&] { return Voxmap::from_bytes(bytes.bytes(), "fuzz.vox", verify); });
    if (!map) continue;
    fuzz::Random random(size);
    fuzz::look_up(*map, random);
    (void)fuzz::within(fuzz::kAudit, size, [&] { return audit_voxmap(*map, "fuzz.vox"); });
    fuzz::feel(std::move(*map), checked ? Model::kPaper : Model::kDefault, random);
  }
  return 0;
}

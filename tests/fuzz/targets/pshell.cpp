// A .pshell file: what opens can be read to its last point, and felt in a small scene.
#include "formats/pshell.h"

#include "forcelayer/run.h"
#include "runtime/model/simulation.h"
#include "tests/fuzz/baked_mutator.h"
#include "tests/fuzz/work.h"
#include "tests/support/aligned_bytes.h"
#include "tests/support/random_scenes.h"

namespace forcelayer::fuzz {
namespace {

using namespace forcelayer::test;

constexpr WorkBound kOpening{10'000, 20};  // a baked file takes 1 block a byte

void feel(Pshell shell) {
  const double s = shell.header().voxel_size_m;
  if (!(s > 1e-9 && s < 1e3)) return;
  Voxmap map =
      make_voxmap(offset_scene(s, {0, 0, -2}, {16, 16, 4}, 2, [](Voxel v) { return v[2] <= 0; }));
  RunRequest request;
  request.without_guarantee = true;
  auto run = open_run(std::move(map), std::move(shell), request);
  if (!run) return;
  model::Simulation& simulation = run->simulation();
  const Pose start{{8 * s, 8 * s, 6 * s}, {1, 0, 0, 0}};
  State state = simulation.registered(start, start);
  for (int frame = 0; frame < 4; ++frame) {
    StepInput input;
    input.world_from_handle = start;
    input.world_from_handle.position_m.z -= frame * s;
    input.valid = 1;
    const StepResult result = simulation.step(state, input, 0.001);
    require(std::isfinite(result.wrench.force_n.z), "a finite force");
  }
}

}  // namespace
}  // namespace forcelayer::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcelayer;
  const testing::AlignedBytes bytes(fuzz::bytes_of(data, size));
  for (const Verify verify : {Verify::kStructureAndChecksums, Verify::kStructure}) {
    auto shell = fuzz::within(fuzz::kOpening, size, [&] {
      return Pshell::from_bytes(bytes.bytes(), "fuzz.pshell", verify);
    });
    if (!shell) continue;
    const PshellView& view = shell->view();
    double sum = 0;
    for (std::uint64_t i = 0; i < view.point_count; ++i) sum += view.x[i] + view.weight_m2[i];
    fuzz::require(std::isfinite(sum), "finite points");
    fuzz::feel(std::move(*shell));
  }
  return 0;
}

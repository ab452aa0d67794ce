// How narrow a gap a part passes: a block in a slot and a peg in a hole, pushed through along the
// axis by a simulated hand, at random places, directions and sizes. No frame may be nearer than the
// printed guarantee, by the exact distance of the meshes (FCL), and none may penetrate.
//
// FORCELAYER_LONG_TESTS=1 tries more maps, places and clearances; the table that it prints is also
// written to the file FORCELAYER_NARROW_GAPS names, as tests/bench/results hold it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <glm/geometric.hpp>
#include <map>
#include <numbers>
#include <random>
#include <sstream>
#include <vector>

#include "formats/guard.h"
#include "runtime/coupling/coupling.h"
#include "runtime/run/separation.h"
#include "tests/stress/exact_distance.h"
#include "tests/stress/shapes.h"
#include "tests/stress/trial.h"

namespace forcelayer::stress {
namespace {

constexpr double kVoxelSizeM = 1e-3;
constexpr double kHoleHalfLength = 4, kPartHalfLength = 3, kRunUp = 7;  // voxels, along the axis
constexpr int kSegments = 24;
const double kUsualCovering = std::sqrt(3.0) / 2;  // voxels

// How the scene is baked, and how densely the part; lengths in voxels.
struct Bake {
  std::string name;
  test::VoxelKind kind = test::VoxelKind::kFull;
  double standoff = 0;  // 0: two layers
  double covering = kUsualCovering;
};

Bake bake_of(double standoff, double covering) {
  char name[40];
  std::snprintf(name, sizeof name, "standoff %.3g", standoff);
  return {name, test::VoxelKind::kFull, standoff, covering};
}

enum class Shape { kBlock, kPeg };
const char* name_of(Shape shape) {
  return shape == Shape::kBlock ? "block in slot" : "peg in hole";
}

bool is_long() { return std::getenv("FORCELAYER_LONG_TESTS") != nullptr; }

// A part and where its gap lies, by seed; the first one is along the grid.
struct Setting {
  double thickness = 0;  // voxels: 2 to 6
  Pose world_from_gap;   // the axis is z, the block's thickness along x
};

Setting setting_of(int seed) {
  std::mt19937_64 engine(static_cast<std::uint64_t>(seed));
  const auto real = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  const auto vector = [&] { return glm::dvec3(real(-1, 1), real(-1, 1), real(-1, 1)); };
  Setting setting;
  setting.thickness = seed % 4 == 1 ? 2 : real(2, 6);
  setting.world_from_gap.position_m = 40 * kVoxelSizeM * vector();
  const glm::dvec3 turn = glm::normalize(vector()) * real(0, 3);
  if (seed % 4 != 1) setting.world_from_gap.orientation = coupling::rotation_by(turn);
  return setting;
}

mesh::Mesh part_of(Shape shape, const Setting& setting) {
  const double s = kVoxelSizeM, half = setting.thickness / 2 * s;
  if (shape == Shape::kPeg) return cylinder(half, kPartHalfLength * s, kSegments);
  return box({half, 3 * s, kPartHalfLength * s});
}

// `room` is the gap's width less the part's thickness, voxels. The hole's faces touch the circle
// that the peg's corners would touch without room.
mesh::Mesh gap_of(Shape shape, const Setting& setting, double room) {
  const double s = kVoxelSizeM, half = (setting.thickness + room) / 2 * s;
  mesh::Mesh mesh;
  if (shape == Shape::kPeg) {
    const double inner = half / std::cos(std::numbers::pi / kSegments);
    append(mesh, tube(inner, inner + 4 * s, kHoleHalfLength * s, kSegments),
           setting.world_from_gap);
    return mesh;
  }
  for (const double side : {-1.0, 1.0}) {
    Pose pose = setting.world_from_gap;
    pose.position_m += pose.orientation * glm::dvec3(side * (half + 2 * s), 0, 0);
    append(mesh, box({2 * s, 7 * s, kHoleHalfLength * s}), pose);
  }
  return mesh;
}

struct Outcome {
  bool passed = false;
  double nearest = 1e300;         // exact distance, voxels
  double guaranteed = 0;          // at every frame, voxels; 0 for none
  std::uint64_t penetrating = 0;  // frames
};

double guaranteed_voxels(const model::Simulation& simulation) {
  const VoxmapHeader& scene = simulation.voxmap().header();
  const DistanceGuard guard{guard_distance_m(scene), simulation.shell().surface_distance_terms()};
  const auto guarantee = separation_guarantee(scene, simulation.shell().header(),
                                              simulation.query().rounding_bound_m(), guard);
  return guarantee.tested_m.value_or(0) / kVoxelSizeM;
}

// Pushes the part from before the gap to behind it, at 0.05 voxels a frame. Where it does not go,
// the hand goes on until it pushes with all that it and the device have.
Outcome push(const Bake& bake, const std::shared_ptr<const BakedPart>& part, Shape shape,
             const Setting& setting, double room) {
  constexpr double kDt = 1e-3, kStep = 0.05 * kVoxelSizeM;
  constexpr double kReach = (kHoleHalfLength + kPartHalfLength + kRunUp) * kVoxelSizeM;
  constexpr double kPull = 30 * kVoxelSizeM;
  Trial trial;
  trial.scene = std::make_shared<BakedScene>(gap_of(shape, setting, room), kVoxelSizeM,
                                             bake.standoff * kVoxelSizeM);
  trial.part = part;
  trial.voxels = bake.kind;
  const auto simulation = make_simulation(trial, Model::kDefault);
  const Pose& gap = setting.world_from_gap;
  const glm::dvec3 axis = gap.orientation * glm::dvec3(0, 0, 1);
  const auto along = [&](double z) { return Pose{gap.position_m + z * axis, gap.orientation}; };
  const Pose start = along(-kReach);
  devices::SimHand hand({}, start);
  State state = simulation->registered(start, start);
  const ExactDistance exact(trial.scene->mesh(), part->mesh());
  PathDistance path(exact, radius_m(part->mesh()));
  Outcome outcome;
  outcome.guaranteed = guaranteed_voxels(*simulation);
  Wrench felt;
  for (double z = -kReach; z < kReach + kPull && !outcome.passed; z += kStep) {
    StepInput input;
    input.world_from_handle = hand.step(along(z), felt, kDt);
    input.valid = kInputValid;
    const StepResult result = simulation->step(state, input, kDt);
    felt = result.at_handle;
    outcome.penetrating += result.report.interior > 0;
    const Pose at = simulation->world_from_part(result.report.world_from_center);
    path.visit(at, glm::dvec3(0));
    outcome.passed = glm::dot(at.position_m - gap.position_m, axis) > kReach;
  }
  outcome.nearest = path.smallest_m() / kVoxelSizeM;
  return outcome;
}

// Promises that every outcome keeps. 1e-6: FCL's own rounding, of a part's size.
void expect_promises(const Outcome& outcome) {
  EXPECT_EQ(outcome.penetrating, 0u);
  EXPECT_GT(outcome.nearest, 0);
  EXPECT_GE(outcome.nearest, outcome.guaranteed - 1e-6);
}

struct Row {
  std::string bake;
  double covering = 0;
  Shape shape = Shape::kBlock;
  double guaranteed = 1e300;  // least of all parts
  double all_pass = 0;        // least room from which on all passed
  double some_pass = 1e300;   // least room that any passed
  double nearest = 1e300;     // exact distance, over all
  int runs = 0;
};

std::string table_of(const std::vector<Row>& rows) {
  std::ostringstream text;
  char date[16];
  const std::time_t now = std::time(nullptr);
  std::strftime(date, sizeof date, "%Y-%m-%d", std::gmtime(&now));
  text << "# machine: seeded simulations, the same on every machine\n"
       << "# run 1: stress_tests --gtest_filter=NarrowGaps.*; " << date << "\n"
       << "run,map,covering_voxels,case,runs,all_pass_voxels,some_pass_voxels,nearest_voxels,"
          "guaranteed_voxels\n";
  for (const Row& row : rows) {
    char line[200];
    std::snprintf(line, sizeof line, "1,%s,%.3f,%s,%d,%.2f,%.2f,%.3f,%.3f\n", row.bake.c_str(),
                  row.covering, name_of(row.shape), row.runs, row.all_pass, row.some_pass,
                  row.nearest, row.guaranteed);
    text << line;
  }
  return text.str();
}

// Rooms of 0.5 to 6 voxels by half a voxel; `fine`: by a tenth where some pass and some do not.
Row measure(const Bake& bake, Shape shape, int settings, bool fine) {
  constexpr int kMaxTenths = 60, kMinTenths = 5;
  Row row{bake.name, bake.covering, shape};
  std::vector<std::shared_ptr<const BakedPart>> parts;
  for (int seed = 1; seed <= settings; ++seed) {
    parts.push_back(std::make_shared<const BakedPart>(part_of(shape, setting_of(seed)), kVoxelSizeM,
                                                      bake.covering * kVoxelSizeM));
  }
  int max_failed = 0, min_passed = kMaxTenths + 1;  // tenths
  const auto try_room = [&](int tenths) {
    for (int seed = 1; seed <= settings; ++seed) {
      SCOPED_TRACE(::testing::Message() << bake.name << ", " << name_of(shape) << ", seed " << seed
                                        << ", room of tenths " << tenths);
      const Outcome outcome = push(bake, parts[static_cast<std::size_t>(seed - 1)], shape,
                                   setting_of(seed), tenths / 10.0);
      expect_promises(outcome);
      ++row.runs;
      row.guaranteed = std::min(row.guaranteed, outcome.guaranteed);
      row.nearest = std::min(row.nearest, outcome.nearest);
      if (outcome.passed) {
        min_passed = std::min(min_passed, tenths);
      } else {
        max_failed = std::max(max_failed, tenths);
      }
    }
  };
  for (int tenths = kMinTenths; tenths <= kMaxTenths; tenths += 5) try_room(tenths);
  if (fine) {
    const int from = min_passed - 4, to = max_failed + 4;
    for (int tenths = from; tenths <= std::min(to, kMaxTenths); ++tenths) {
      if (tenths % 5 != 0) try_room(tenths);
    }
  }
  row.all_pass = (max_failed + (fine ? 1 : 5)) / 10.0;
  row.some_pass = min_passed / 10.0;
  return row;
}

TEST(NarrowGaps, ArePassedWithoutComingNearerThanPromised) {
  std::vector<Bake> bakes{{"lean", test::VoxelKind::kLean},
                          {"full", test::VoxelKind::kFull},
                          bake_of(1.3, kUsualCovering),
                          bake_of(1.03, kUsualCovering / 2)};
  if (is_long()) {
    for (const double standoff : {1.4, 1.6, 2.0, 2.867}) {
      bakes.push_back(bake_of(standoff, kUsualCovering));
    }
    for (const double standoff : {0.97, 1.1, 1.3}) {
      bakes.push_back(bake_of(standoff, kUsualCovering / 2));
    }
  }
  std::vector<Row> rows;
  for (const Bake& bake : bakes) {
    for (const Shape shape : {Shape::kBlock, Shape::kPeg}) {
      rows.push_back(measure(bake, shape, is_long() ? 8 : 2, is_long()));
      // A test that nothing passes, or everything, measures nothing.
      EXPECT_LE(rows.back().some_pass, 6) << bake.name;
      EXPECT_GT(rows.back().all_pass, 0.5) << bake.name;
    }
  }
  const std::string table = table_of(rows);
  std::fputs(table.c_str(), stdout);
  if (const char* path = std::getenv("FORCELAYER_NARROW_GAPS")) std::ofstream(path) << table;
}

// The room that --plan and voxinfo promise is passed: anywhere, in any direction. Standoffs of 1.3
// and 1.03 voxels are what rooms of 2.6 and 2.1 voxels need, by shells of the usual covering radius
// and of half of it.
TEST(NarrowGaps, OfThePromisedRoomArePassedAnywhere) {
  const int settings = is_long() ? 200 : 20;
  for (const Bake& bake :
       {Bake{"lean", test::VoxelKind::kLean}, Bake{"full", test::VoxelKind::kFull},
        bake_of(1.3, kUsualCovering), bake_of(1.03, kUsualCovering / 2)}) {
    double room = 0;
    for (int seed = 1; seed <= settings; ++seed) {
      SCOPED_TRACE(::testing::Message() << bake.name << ", seed " << seed);
      const Setting setting = setting_of(seed);
      const auto part = std::make_shared<const BakedPart>(part_of(Shape::kBlock, setting),
                                                          kVoxelSizeM, bake.covering * kVoxelSizeM);
      if (seed == 1) {
        const BakedScene some(gap_of(Shape::kBlock, setting, 6), kVoxelSizeM,
                              bake.standoff * kVoxelSizeM);
        room = passed_gap_m(some.open(bake.kind).header()) / kVoxelSizeM;
        // The bake rounds standoffs up to 2^-10 voxel.
        EXPECT_LE(room - 2.0 / 1024, bake.standoff == 1.3 ? 2.6 : bake.standoff == 1.03 ? 2.1 : 9);
      }
      const Outcome outcome = push(bake, part, Shape::kBlock, setting, room);
      EXPECT_TRUE(outcome.passed) << "room " << room;
      expect_promises(outcome);
      EXPECT_GT(outcome.guaranteed, 0.1);
    }
  }
}

}  // namespace
}  // namespace forcelayer::stress

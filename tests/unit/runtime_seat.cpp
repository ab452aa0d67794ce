// The seat of a part that starts installed, on scenes that are formulas.
#include <gtest/gtest.h>

#include <cmath>

#include "runtime/run/baked_files.h"
#include "runtime/stream/recording.h"
#include "tests/support/distance_scene.h"
#include "tests/support/motion_bench.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005;

// A floor: solid below z = 0.
VoxelScene floor_with_distances() {
  return distance_scene(
      kS, {-12, -12, -8}, {24, 24, 24}, [](const glm::dvec3& p) { return p.z; }, 2,
      DistanceDefinition(2));
}

// A sheet without thickness at z = 0, midway between voxel centers.
VoxelScene sheet_with_distances() {
  return distance_scene(
      kS, {-12, -12, -12}, {24, 24, 24}, [](const glm::dvec3& p) { return std::abs(p.z); }, 2,
      DistanceDefinition(2));
}

constexpr double kHalf = 0.01;  // of the block's height
PointPart block() { return box_part({0.015, 0.012, kHalf}, 0.8 * kS, kS); }
Pose resting(double gap_m = 0) { return {{0.0007, 0.0003, kHalf + gap_m}, {1, 0, 0, 0}}; }

struct SeatedBlock : MotionBench {
  explicit SeatedBlock(const VoxelScene& scene, const Pose& at = resting())
      : MotionBench(scene, block(), at) {
    PartStart start;
    start.world_from_part = at;
    begun = simulation->begin(start, at);
    if (begun) state = *begun;
  }
  // To a place in steps of a tenth of a millimeter.
  StepResult move_by(const glm::dvec3& way_m, int frames) {
    StepResult result;
    const Pose from = input.world_from_handle;
    for (int i = 1; i <= frames; ++i) {
      Pose to = from;
      to.position_m += way_m * (i / static_cast<double>(frames));
      result = step_to(to);
    }
    return result;
  }
  Result<State> begun = State{};
};

TEST(Seat, APartThatRestsIsAtRestWithoutForce) {
  SeatedBlock bench(floor_with_distances());
  ASSERT_TRUE(bench.begun) << to_line(bench.begun.error());
  ASSERT_EQ(bench.simulation->seat().size(), 1u);
  EXPECT_GT(bench.simulation->seat()[0].points, 10u);
  const Pose before = bench.part();
  StepResult result;
  for (int i = 0; i < 200; ++i) result = bench.hold();
  EXPECT_EQ(glm::length(result.wrench.force_n), 0);
  EXPECT_EQ(glm::length(bench.part().position_m - before.position_m), 0);
  EXPECT_GT(result.report.seated, 0u);
  EXPECT_EQ(result.report.interior, 0u);
  EXPECT_EQ(result.report.clearance_kind, ClearanceKind::kNone);
  EXPECT_EQ(bench.state.seat, kSeatEntered);
}

TEST(Seat, APartThatIsPushedIsHeldAndSlides) {
  for (const VoxelScene& scene : {floor_with_distances(), sheet_with_distances()}) {
    SeatedBlock bench(scene);
    ASSERT_TRUE(bench.begun) << to_line(bench.begun.error());
    const double start_m = bench.part().position_m.z;
    StepResult result = bench.move_by({0, 0, -0.03}, 300);
    for (int i = 0; i < 300; ++i) result = bench.hold();
    EXPECT_GT(result.wrench.force_n.z, 5);
    // A quarter of a voxel, and on a sheet as far as its middle.
    EXPECT_GT(bench.part().position_m.z, start_m - 0.55 * kS);
    EXPECT_EQ(result.report.interior, 0u);
    // Along the floor, pressed lightly.
    bench.move_by({0, 0, 0.029}, 300);
    const double x_m = bench.part().position_m.x;
    bench.move_by({0.01, 0, 0}, 300);
    EXPECT_NEAR(bench.part().position_m.x, x_m + 0.01, 0.2 * kS);
  }
}

TEST(Seat, ClosesWhenThePartHasLeftAndIsNeverOpenedAgain) {
  SeatedBlock bench(floor_with_distances());
  ASSERT_TRUE(bench.begun);
  bench.move_by({0, 0, 1.5 * kS}, 200);
  EXPECT_EQ(bench.state.seat, kSeatEntered);
  bench.move_by({0, 0, -1.5 * kS}, 200);
  EXPECT_NEAR(bench.part().position_m.z, kHalf, 0.1 * kS);  // back in its seat
  const StepResult away = bench.move_by({0, 0, 4 * kS}, 400);
  EXPECT_EQ(bench.state.seat, kSeatClosed);
  EXPECT_NE(away.report.clearance_kind, ClearanceKind::kNone);
  bench.move_by({0, 0, -4 * kS}, 400);
  EXPECT_EQ(bench.state.seat, kSeatClosed);
  EXPECT_GT(bench.part().position_m.z, kHalf + 1.6 * kS);  // the guard's distance
  // The clutch does not open it either.
  bench.input.valid = kInputClutched;
  bench.hold();
  EXPECT_EQ(bench.state.seat, kSeatClosed);
}

TEST(Seat, TheClutchKeepsIt) {
  SeatedBlock bench(floor_with_distances());
  ASSERT_TRUE(bench.begun);
  bench.hold();
  bench.input.valid = kInputClutched;
  bench.hold();
  bench.input.valid = kInputValid;
  const StepResult result = bench.hold();
  EXPECT_EQ(bench.state.seat, kSeatEntered);
  EXPECT_EQ(glm::length(result.wrench.force_n), 0);
}

// Installed elsewhere than where it starts: the seat is open until the part was there.
TEST(Seat, APartCanBePutWhereItIsInstalled) {
  const Pose above = resting(6 * kS);
  MotionBench bench(floor_with_distances(), block(), above);
  PartStart start;
  start.world_from_part = above;
  start.world_from_seat = resting();
  const auto begun = bench.simulation->begin(start, above);
  ASSERT_TRUE(begun) << to_line(begun.error());
  bench.state = *begun;
  for (int i = 1; i <= 600; ++i) {
    Pose to = above;
    to.position_m.z -= 6 * kS * (i / 600.0);
    bench.step_to(to);
  }
  EXPECT_NEAR(bench.part().position_m.z, kHalf, 0.1 * kS);
  EXPECT_EQ(bench.state.seat, kSeatEntered);
}

TEST(Seat, WhatCannotBeToldIsRefused) {
  VoxelScene lean = floor_with_distances();
  lean.codes.clear();
  lean.distances = {};
  const SeatedBlock in_lean(lean);
  ASSERT_FALSE(in_lean.begun);
  EXPECT_EQ(in_lean.begun.error().code, ErrorCode::kUsage);
  EXPECT_NE(in_lean.begun.error().mend.find("without --lean"), std::string::npos);

  const SeatedBlock deep(floor_with_distances(), resting(-0.9 * kS));
  ASSERT_FALSE(deep.begun);
  EXPECT_NE(deep.begun.error().what.find("inside the scene"), std::string::npos);
  EXPECT_NE(deep.begun.error().mend.find("--range"), std::string::npos);

  const SeatedBlock shallow(floor_with_distances(), resting(-0.3 * kS));
  ASSERT_TRUE(shallow.begun);
  EXPECT_NEAR(shallow.simulation->seat()[0].overlap_m, 0.3 * kS, 0.05 * kS);

  const SeatedBlock clear(floor_with_distances(), resting(5 * kS));
  ASSERT_TRUE(clear.begun);
  EXPECT_TRUE(clear.simulation->seat().empty());
  EXPECT_EQ(clear.state.seat, kSeatClosed);
}

// A part that is installed elsewhere may start anywhere but in the scene.
TEST(Seat, AStartApartFromTheSeatIsClear) {
  MotionBench bench(floor_with_distances(), block(), resting(6 * kS));
  const auto begin = [&](const Pose& at) {
    PartStart start;
    start.world_from_part = at;
    start.world_from_seat = resting();
    return bench.simulation->begin(start, at);
  };
  EXPECT_TRUE(begin(resting()));
  EXPECT_TRUE(begin(resting(6 * kS)));
  const auto inside = begin(resting(-0.5 * kS));
  ASSERT_FALSE(inside);
  EXPECT_EQ(inside.error().code, ErrorCode::kUsage);
  EXPECT_NE(inside.error().what.find("not where its seat is"), std::string::npos);
}

TEST(Seat, AForceWithoutDistancesIsRefusedForWhatItIs) {
  RunRequest request;
  request.device = paper_device();
  request.without_guarantee = true;
  request.force = ForceKind::kLevel;
  auto run = open_run(make_voxmap(floor_with_distances()), make_pshell(block()), request);
  ASSERT_TRUE(run) << to_line(run.error());
  PartStart start;
  start.world_from_part = resting();
  const auto begun = run->simulation().begin(start, resting());
  ASSERT_FALSE(begun);
  EXPECT_NE(begun.error().mend.find("leave out --force"), std::string::npos);
}

TEST(Seat, ARecordingHasIt) {
  SeatedBlock bench(floor_with_distances());
  ASSERT_TRUE(bench.begun);
  const ScratchFolder folder;
  auto writer = stream::RecordingWriter::create(folder / "run.flr");
  ASSERT_TRUE(writer);
  writer->begin(stream::describe_run(*bench.simulation, bench.state, {}));
  ASSERT_TRUE(writer->finish(0));
  const auto recording = stream::Recording::open(folder / "run.flr");
  ASSERT_TRUE(recording) << to_line(recording.error());
  EXPECT_EQ(recording->run().start.seat, kSeatOpen);
  ASSERT_TRUE(recording->run().world_from_seat);
  EXPECT_EQ(recording->run().world_from_seat->position_m,
            bench.begun->world_from_center.position_m);
}

}  // namespace
}  // namespace forcelayer::test

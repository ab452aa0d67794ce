// The paper's model on cases that can be worked out by hand.
#include "runtime/model/paper_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <stdexcept>

#include "forcelayer/run.h"
#include "tests/support/point_part.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.01;  // voxel size, m
constexpr double kDt = 0.001;

// A floor: geometric surface at k = 0, so interior below 2, force layer k = 2, proximity k = 3.
VoxelScene floor_scene() {
  return offset_scene(kS, {-20, -20, -2}, {40, 40, 8}, 2, [](Voxel v) { return v[2] <= 0; });
}

struct Bench {
  std::unique_ptr<model::Simulation> simulation;
  State state;
  StepInput input;
};

// `points` of the part lie at the given offsets (voxels), normals up (inward: the floor is below).
Bench bench(const std::vector<std::array<double, 3>>& points, glm::dvec3 center_voxels,
            bool braking = false) {
  PointPart part;
  part.voxel_size_m = kS;
  for (const auto& p : points) part.add({p[0] * kS, p[1] * kS, p[2] * kS}, {0, 0, 1});
  RunRequest request;
  request.model = Model::kPaper;
  request.braking = braking;
  request.device = {};
  request.device.max_force_n = request.device.max_torque_nm = 100;
  request.without_guarantee = true;  // of a few points
  auto run = open_run(make_voxmap(floor_scene()), make_pshell(part), request);
  if (!run) throw std::runtime_error(to_line(run.error()));
  Bench b;
  b.simulation = run->release_simulation();
  Pose pose;
  pose.position_m = center_voxels * kS;
  b.state = b.simulation->registered(pose, pose);
  b.input.valid = 1;
  b.input.world_from_handle = pose;
  return b;
}

glm::dvec3 force_from_velocity(const Bench& b, const State& before) {
  return (b.state.velocity.linear_mps - before.velocity.linear_mps) *
         (b.simulation->parameters().mass_kg / kDt);
}

TEST(PaperModel, FreeSpaceGivesExactlyNothingToTheHand) {
  Bench b = bench({{0, 0, 0}}, {0, 0, 4.5});
  b.input.world_from_handle.position_m.x += 0.3;  // the spring pulls, the hand must not feel it
  b.input.handle_velocity.linear_mps = {1, 2, 3};
  const StepResult result = b.simulation->step(b.state, b.input, kDt);
  EXPECT_EQ(result.wrench.force_n, glm::dvec3(0));
  EXPECT_EQ(result.wrench.torque_nm, glm::dvec3(0));
  EXPECT_GT(b.state.velocity.linear_mps.x, 0);  // the part moves all the same
}

TEST(PaperModel, ForceIsStiffnessTimesDepthBelowTheVoxelsCentre) {
  Bench b = bench({{0, 0, 0}}, {0.5, 0.5, 2.25});
  const State before = b.state;
  const StepResult result = b.simulation->step(b.state, b.input, kDt);
  EXPECT_EQ(result.report.surface, 1u);
  EXPECT_EQ(result.report.contacts, 1u);
  EXPECT_NEAR(result.report.depth_m, 0.25 * kS, 1e-6 * kS);
  const double expected_n = b.simulation->parameters().field_n_per_m * 0.25 * kS;
  // Single precision of the depth: 2^-24 of a voxel over a quarter of one, a few roundings.
  EXPECT_NEAR(force_from_velocity(b, before).z, expected_n, 1e-6 * expected_n);
}

TEST(PaperModel, APointAboveTheTangentPlaneIsAnIntersectionButNoContact) {
  Bench b = bench({{0, 0, 0}}, {0.5, 0.5, 2.75});
  const StepResult result = b.simulation->step(b.state, b.input, kDt);
  EXPECT_EQ(result.report.surface, 1u);
  EXPECT_EQ(result.report.contacts, 0u);
  EXPECT_EQ(result.report.depth_m, 0);
  EXPECT_EQ(b.state.velocity.linear_mps, glm::dvec3(0));
}

TEST(PaperModel, InteriorPointsAreCountedAndPressNothing) {
  Bench b = bench({{0, 0, 0}}, {0.5, 0.5, 1.5});
  const StepResult result = b.simulation->step(b.state, b.input, kDt);
  EXPECT_EQ(result.report.interior, 1u);
  EXPECT_EQ(result.report.contacts, 0u);
  EXPECT_EQ(b.state.velocity.linear_mps, glm::dvec3(0));
}

// N points in a row, all a quarter voxel deep: the sum up to 9, the sum over N/10 from 10 on.
TEST(PaperModel, ForcesAreAveragedFromTenIntersectionsOn) {
  for (const int n : {1, 9, 10, 11, 25}) {
    std::vector<std::array<double, 3>> points;
    for (int i = 0; i < n; ++i) points.push_back({0.3 * (i - (n - 1) / 2.0), 0, 0});
    Bench b = bench(points, {0.5, 0.5, 2.25});
    const State before = b.state;
    const StepResult result = b.simulation->step(b.state, b.input, kDt);
    ASSERT_EQ(result.report.surface, static_cast<std::uint32_t>(n));
    const double one_n = b.simulation->parameters().field_n_per_m * 0.25 * kS;
    const double expected_n = n < 10 ? n * one_n : 10 * one_n;
    EXPECT_NEAR(force_from_velocity(b, before).z, expected_n, 1e-5 * expected_n) << n;
  }
}

// An intersection without depth counts for N all the same.
TEST(PaperModel, IntersectionsWithoutDepthCountForTheAverage) {
  std::vector<std::array<double, 3>> points;
  for (int i = 0; i < 10; ++i) points.push_back({0.3 * i, 0, 0});
  for (int i = 0; i < 10; ++i) points.push_back({0.3 * i, 0, 0.5});
  Bench b = bench(points, {0.5, 0.5, 2.25});
  const State before = b.state;
  const StepResult result = b.simulation->step(b.state, b.input, kDt);
  ASSERT_EQ(result.report.surface, 20u);
  ASSERT_EQ(result.report.contacts, 10u);
  const double one_n = b.simulation->parameters().field_n_per_m * 0.25 * kS;
  EXPECT_NEAR(force_from_velocity(b, before).z, 5 * one_n, 1e-5 * one_n);
}

TEST(PaperModel, TorqueIsAboutTheCentroid) {
  Bench b = bench({{2, 0, 0}, {-2, 0, 1.5}}, {0.5, 0.5, 2.25});
  b.simulation->step(b.state, b.input, kDt);
  const Parameters& p = b.simulation->parameters();
  const double torque_nm = -2 * kS * p.field_n_per_m * 0.25 * kS;  // x cross z = -y
  EXPECT_NEAR(b.state.velocity.angular_radps.y, torque_nm * kDt / p.inertia_kgm2[0][0],
              1e-5 * std::abs(b.state.velocity.angular_radps.y));
}

TEST(PaperModel, TheSpringIsClampedAtHalfAVoxelAndTheDamperIsNot) {
  Bench b = bench({{0, 0, 0}}, {0.5, 0.5, 3.5});  // proximity: the hand feels the spring
  const Parameters& p = b.simulation->parameters();
  b.input.world_from_handle.position_m.x += 0.4 * kS;
  State state = b.state;
  StepResult result = b.simulation->step(state, b.input, kDt);
  EXPECT_EQ(result.report.saturated, 0u);
  EXPECT_NEAR(result.wrench.force_n.x, -p.coupling_n_per_m * 0.4 * kS, 1e-12);
  b.input.world_from_handle.position_m.x += 40 * kS;
  b.input.handle_velocity.linear_mps = {2, 0, 0};
  state = b.state;
  result = b.simulation->step(state, b.input, kDt);
  EXPECT_EQ(result.report.saturated, 1u);
  EXPECT_NEAR(result.wrench.force_n.x, -p.coupling_n_per_m * kS / 2 - 2 * p.coupling_ns_per_m,
              1e-12);
}

// One approaching point: S is along v, so braking takes half of the velocity's energy rate over dt:
// F = -(m v^2 / 2) / dt / v, half of the velocity in one frame.
TEST(PaperModel, BrakingTakesHalfOfTheApproachInAFrame) {
  Bench b = bench({{0, 0, 0}}, {0.5, 0.5, 3.5}, true);
  b.state.velocity.linear_mps = b.input.handle_velocity.linear_mps = {0, 0, -0.2};
  b.simulation->step(b.state, b.input, kDt);
  EXPECT_NEAR(b.state.velocity.linear_mps.z, -0.1, 1e-12);
}

TEST(PaperModel, BrakingLeavesRecedingPointsAlone) {
  Bench b = bench({{0, 0, 0}}, {0.5, 0.5, 3.5}, true);
  b.state.velocity.linear_mps = b.input.handle_velocity.linear_mps = {0, 0, 0.2};
  b.simulation->step(b.state, b.input, kDt);
  EXPECT_EQ(b.state.velocity.linear_mps.z, 0.2);
}

// A part at rest: S vanishes, 0/0 in the paper, zero here.
TEST(PaperModel, BrakingIsZeroWhereTheSumVanishes) {
  Bench b = bench({{0, 0, 0}}, {0.5, 0.5, 3.5}, true);
  b.state.velocity.linear_mps = glm::dvec3(0);
  b.simulation->step(b.state, b.input, kDt);
  EXPECT_EQ(b.state.velocity.linear_mps, glm::dvec3(0));
}

// A part that recedes slowly while one end turns fast towards the wall: v . S < 0, b would push.
TEST(PaperModel, BrakingNeverPushes) {
  Bench b = bench({{2, 0, 0}}, {0.5, 0.5, 3.5}, true);
  b.state.velocity.linear_mps = b.input.handle_velocity.linear_mps = {0, 0, 0.1};
  b.state.velocity.angular_radps = b.input.handle_velocity.angular_radps = {0, 50, 0};
  b.simulation->step(b.state, b.input, kDt);
  EXPECT_EQ(b.state.velocity.linear_mps.z, 0.1);
}

TEST(PaperModel, BadInputFreezesThePartAndGivesNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (int bad = 0; bad < 4; ++bad) {
    Bench b = bench({{0, 0, 0}}, {0.5, 0.5, 2.25});
    b.state.velocity.linear_mps = {1, 0, 0};
    if (bad == 0) b.input.valid = 0;
    if (bad == 1) b.input.world_from_handle.position_m.y = nan;
    if (bad == 2) b.input.handle_velocity.angular_radps.z = 1 / 0.0;
    if (bad == 3) b.input.world_from_handle.orientation = {0, 0, 0, 0};
    const Pose before = b.state.world_from_center;
    const StepResult result = b.simulation->step(b.state, b.input, kDt);
    EXPECT_EQ(result.report.faults, bad == 0 ? kFaultInvalidInput : kFaultNonFiniteInput);
    EXPECT_EQ(result.wrench.force_n, glm::dvec3(0));
    EXPECT_EQ(b.state.world_from_center.position_m, before.position_m);
    EXPECT_EQ(b.state.velocity.linear_mps, glm::dvec3(0));
  }
}

TEST(PaperModel, AnOverflowingMotionIsStopped) {
  Bench b = bench({{0, 0, 0}}, {0.5, 0.5, 3.5});
  b.input.world_from_handle.position_m.x = 1e308;
  b.input.handle_velocity.linear_mps.x = 1e308;
  const StepResult result = b.simulation->step(b.state, b.input, kDt);
  EXPECT_EQ(result.report.faults, kFaultNonFiniteState);
  EXPECT_EQ(result.wrench.force_n, glm::dvec3(0));
  EXPECT_TRUE(std::isfinite(b.state.world_from_center.position_m.x));
}

}  // namespace
}  // namespace forcelayer::test

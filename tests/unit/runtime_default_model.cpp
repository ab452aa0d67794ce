// The default model on cases with a known answer: free space, press, thin wall, start inside, bad
// input, replay.
#include "runtime/model/default_model.h"

#include <gtest/gtest.h>

#include <cstring>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "runtime/guard/pose_guard.h"
#include "tests/support/motion_bench.h"

namespace forcelayer::test {
namespace {

constexpr double kS = 0.005;  // voxel size, m

bool finite(const glm::dvec3& v) { return !glm::any(glm::isnan(v)) && !glm::any(glm::isinf(v)); }

bool finite(const StepResult& r) { return finite(r.wrench.force_n) && finite(r.wrench.torque_nm); }

Pose at(const glm::dvec3& position_m) { return {position_m, {1, 0, 0, 0}}; }

// A floor: geometric surface at voxel k = 0, so interior below 2, force layer 2, proximity 3.
VoxelScene floor_scene(double s) {
  return shape_scene(s, {-24, -24, -3}, {48, 48, 12},
                     [s](const glm::dvec3& p) { return p.z - 0.3 * s; });
}

PointPart ball(double s) { return sphere_part(4 * s, 200, s); }

TEST(DefaultModel, FreeSpaceGivesExactlyNothingToTheHand) {
  MotionBench bench(floor_scene(kS), ball(kS), at({0, 0, 20 * kS}));
  for (int frame = 0; frame < 100; ++frame) {
    const StepResult result = bench.step_to(at({0.0002 * frame, 0, 20 * kS}));
    EXPECT_EQ(result.wrench.force_n, glm::dvec3(0));
    EXPECT_EQ(result.wrench.torque_nm, glm::dvec3(0));
  }
  EXPECT_GT(bench.part().position_m.x, 0.01);  // the part follows all the same
}

// 15 N (the device's limit) hold with every voxel size: the clamp is not tied to it, and the part
// stays within a quarter of a voxel of where the force layer begins to push.
TEST(DefaultModel, APressOfTheDevicesForceHoldsWithEveryVoxelSize) {
  for (const double s : {0.005, 0.002, 0.001}) {
    MotionBench bench(floor_scene(s), ball(s), at({0.001, 0.002, 12 * s}));
    StepResult result;
    const double below_m = 12 * s + 0.02;  // 20 mm: far more than 15 N of stretch
    for (int frame = 0; frame < 1000; ++frame) {
      const double fraction = std::min(1.0, frame / 400.0);
      result = bench.step_to(at({0.001, 0.002, 12 * s - fraction * below_m}));
      ASSERT_EQ(result.report.interior, 0u) << s << " frame " << frame;
    }
    EXPECT_NEAR(glm::length(result.wrench.force_n), 15, 1e-9) << s;
    EXPECT_GT(result.wrench.force_n.z, 14.9) << s;
    // The ball's lowest points (4 voxels down) touch at the middle of the force layer, 2.5 s.
    EXPECT_NEAR(bench.part().position_m.z / s, 6.5, 0.25) << s;
    const State before = bench.state;
    for (int frame = 0; frame < 1000; ++frame) bench.hold();
    EXPECT_EQ(bench.state.world_from_center.position_m, before.world_from_center.position_m);
    EXPECT_EQ(bench.state.world_from_center.orientation, before.world_from_center.orientation);
  }
}

// Below the clamp the hand feels the coupling in series with the contact.
TEST(DefaultModel, AGentlePressIsAsStiffAsTheCoupling) {
  MotionBench bench(floor_scene(kS), ball(kS), at({0.001, 0.002, 12 * kS}));
  StepResult result;
  const double target_z_m = 6.5 * kS - 0.004;
  for (int frame = 0; frame < 2000; ++frame) {
    const double fraction = std::min(1.0, frame / 400.0);
    result = bench.step_to(at({0.001, 0.002, 12 * kS + fraction * (target_z_m - 12 * kS)}));
  }
  const double stretch_m = bench.part().position_m.z - target_z_m;
  EXPECT_NEAR(result.wrench.force_n.z, bench.parameters().coupling_n_per_m * stretch_m, 1e-9);
  EXPECT_GT(stretch_m, 0.75 * 0.004);
}

// One voxel of solid, hit at up to 100 m/s: the part never enters and never gets to the far side.
TEST(DefaultModel, AThinWallIsNeverCrossed) {
  const VoxelScene wall = shape_scene(kS, {-24, -24, -12}, {48, 48, 24}, [](const glm::dvec3& p) {
    return std::abs(p.z - 0.5 * kS) - 0.4 * kS;
  });
  for (const double speed_mps : {0.5, 2.0, 10.0, 100.0}) {
    MotionBench bench(wall, ball(kS), at({0.001, 0.002, 20 * kS}));
    double z_m = 20 * kS;
    for (int frame = 0; frame < 400; ++frame) {
      z_m = std::max(-20 * kS, z_m - speed_mps * bench.dt_s);
      const StepResult result = bench.step_to(at({0.001, 0.002, z_m}));
      ASSERT_EQ(result.report.interior, 0u) << speed_mps << " m/s, frame " << frame;
      ASSERT_TRUE(finite(result));
    }
    EXPECT_GT(bench.part().position_m.z, 5.5 * kS) << speed_mps;
  }
}

// A heavy part that flies, without braking: its energy would pay for the way in, so that it is the
// guard alone that stops it.
TEST(DefaultModel, APartWithEnergyToSpareIsStoppedByTheGuard) {
  for (const double speed_mps : {1.0, 5.0, 20.0}) {
    MotionBench bench(floor_scene(kS), ball(kS), at({0.001, 0.002, 12 * kS}),
                      {.braking = false, .settings = {{"mass_kg", 2}}});
    bench.state.velocity.linear_mps = {0, 0, -speed_mps};
    std::uint32_t touching = 0;
    for (int frame = 0; frame < 200; ++frame) {
      const StepResult result = bench.hold();
      ASSERT_EQ(result.report.interior, 0u) << speed_mps << " m/s, frame " << frame;
      touching += result.report.surface;
    }
    EXPECT_GT(touching, 0u) << speed_mps;
  }
}

// The part starts a voxel and a half too deep, gripped without stretch: reported as penetration,
// led out at no more than the recovery speed, and the force rises no faster than that stretches the
// coupling.
TEST(DefaultModel, AStartInsideIsLedOutGently) {
  MotionBench bench(floor_scene(kS), ball(kS), at({0.001, 0.002, 5 * kS}));
  int inside = 0;
  double last_n = 0;
  for (int frame = 0; frame < 2000; ++frame) {
    const glm::dvec3 before_m = bench.part().position_m;
    const StepResult result = bench.hold();
    inside += result.report.interior > 0;
    const double way_m = glm::length(bench.part().position_m - before_m);
    if (result.report.interior > 0) {
      EXPECT_LE(way_m, bench.parameters().recovery_mps * bench.dt_s * (1 + 1e-9));
      const double force_n = glm::length(result.wrench.force_n);
      const double damper_n =
          bench.parameters().coupling_ns_per_m * bench.parameters().recovery_mps;
      EXPECT_LE(force_n, last_n + bench.parameters().coupling_n_per_m * way_m + 2 * damper_n);
      last_n = force_n;
    }
  }
  EXPECT_GT(inside, 0);
  EXPECT_LT(inside, 1000);
  EXPECT_EQ(bench.hold().report.interior, 0u);
}

// NaN, infinity, denormals and a standing clock never leave a trace in state or output.
TEST(DefaultModel, BadInputNeverPropagates) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  const double tiny = std::numeric_limits<double>::denorm_min();
  MotionBench bench(floor_scene(kS), ball(kS), at({0.001, 0.002, 7 * kS}));
  for (const double bad : {nan, inf, -inf, tiny, 1e300, -1e300, 1e18}) {
    for (int place = 0; place < 4; ++place) {
      StepInput input = bench.input;
      if (place == 0) input.world_from_handle.position_m.y = bad;
      if (place == 1) input.world_from_handle.orientation.x = bad;
      if (place == 2) input.handle_velocity.linear_mps.z = bad;
      if (place == 3) input.handle_velocity.angular_radps.x = bad;
      const StepResult result = bench.simulation->step(bench.state, input, bench.dt_s);
      ASSERT_TRUE(finite(result)) << bad << " at " << place;
      ASSERT_TRUE(finite(bench.part().position_m)) << bad << " at " << place;
      ASSERT_LE(glm::length(result.wrench.force_n), 15 * (1 + 1e-12));
      ASSERT_LE(glm::length(result.wrench.torque_nm), 0.1 * (1 + 1e-12));
    }
  }
  for (const double dt_s : {0.0, tiny, 1e-12, 10.0}) {
    const StepResult result = bench.simulation->step(bench.state, bench.input, dt_s);
    ASSERT_TRUE(finite(result)) << dt_s;
    ASSERT_TRUE(finite(bench.part().position_m)) << dt_s;
    ASSERT_EQ(result.report.interior, 0u) << dt_s;
  }
}

// A hand that jumps about at random: never inside, never beyond the limits, and a second simulation
// that is given the same inputs gives the same bits.
TEST(DefaultModel, ARandomHandNeverGetsInsideAndReplaysBitForBit) {
  const std::uint64_t seed = 20240611;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  const VoxelScene scene = shape_scene(kS, {-24, -24, -24}, {48, 48, 48}, [](const glm::dvec3& p) {
    return std::min(glm::length(p) - 6.3 * kS,
                    glm::dot(p, glm::dvec3(0.48, 0.64, 0.6)) + 14.2 * kS);
  });
  const PointPart part = box_part(glm::dvec3(4, 2, 1.5) * kS, kS, kS);
  const Pose start = at(glm::dvec3(14, 14, 0) * kS);
  MotionBench bench(scene, part, start), again(scene, part, start);
  Pose goal = start, handle = start;
  for (int frame = 0; frame < 20000; ++frame) {
    if (frame % 500 == 0) {
      goal = {random_direction(random) * uniform(random, 0, 20) * kS, random_orientation(random)};
    }
    const double fraction = frame % 5000 < 100 ? 1 : 0.02;  // now and then it jumps
    handle.position_m += fraction * (goal.position_m - handle.position_m);
    handle.orientation = glm::normalize(
        glm::slerp(handle.orientation, goal.orientation, 1.5 * fraction / (1 + fraction)));
    const StepResult a = bench.step_to(handle), b = again.step_to(handle);
    ASSERT_EQ(a.report.interior, 0u) << frame;
    ASSERT_TRUE(finite(a)) << frame;
    ASSERT_LE(glm::length(a.wrench.force_n), 15 * (1 + 1e-12)) << frame;
    ASSERT_LE(glm::length(a.wrench.torque_nm), 0.1 * (1 + 1e-12)) << frame;
    ASSERT_EQ(std::memcmp(&bench.state, &again.state, sizeof(State)), 0) << frame;
    ASSERT_EQ(std::memcmp(&a.wrench, &b.wrench, sizeof(Wrench)), 0) << frame;
  }
}

// A step depends on its arguments alone: going back to an old state and stepping on gives what it
// gave the first time, whatever the simulation did between.
TEST(DefaultModel, AStepIsAPureFunctionOfItsArguments) {
  MotionBench bench(floor_scene(kS), ball(kS), at({0.001, 0.002, 7.2 * kS}));
  for (int frame = 0; frame < 50; ++frame)
    bench.step_to(at({0.001, 0.002, 7.2 * kS - 1e-4 * frame}));
  const State kept = bench.state;
  const StepInput input = bench.input;
  const StepResult first = bench.simulation->step(bench.state, input, bench.dt_s);
  const State after = bench.state;
  for (int frame = 0; frame < 50; ++frame) bench.step_to(at({0.01, 0.002, 20 * kS}));
  bench.state = kept;
  const StepResult second = bench.simulation->step(bench.state, input, bench.dt_s);
  EXPECT_EQ(std::memcmp(&bench.state, &after, sizeof(State)), 0);
  EXPECT_EQ(std::memcmp(&first.wrench, &second.wrench, sizeof(Wrench)), 0);
}

// The hand turns on past half a turn while the part is held by a slot: the torque keeps its sense.
TEST(DefaultModel, TheCouplingsAngleIsContinuousPastHalfATurn) {
  // A slot along x between two walls at y = +-5 voxels: the plate can not turn about z.
  const VoxelScene slot = shape_scene(kS, {-30, -30, -10}, {60, 60, 20},
                                      [](const glm::dvec3& p) { return 5 * kS - std::abs(p.y); });
  MotionBench bench(slot, box_part(glm::dvec3(12, 1, 1) * kS, kS, kS), at({0, 0, 0}));
  for (int frame = 0; frame <= 2000; ++frame) {
    const double angle = 1.4 * M_PI * frame / 2000;
    const Pose handle{{0, 0, 0}, {std::cos(angle / 2), 0, 0, std::sin(angle / 2)}};
    const StepResult result = bench.step_to(handle);
    if (angle > 0.5) {
      EXPECT_LT(result.wrench.torque_nm.z, -0.09) << angle;
    }
    ASSERT_EQ(result.report.interior, 0u);
  }
}

// Remembers what was looked up, and what was there.
class WatchedProbe final : public field::ContactProbe {
 public:
  explicit WatchedProbe(field::ContactProbe& probe) : probe_(probe) {}
  void query_pose(const Pose& pose, field::ContactSet& out) noexcept override {
    probe_.query_pose(pose, out);
    if (out.interior == 0) clear.push_back(pose);
  }
  std::vector<Pose> clear;  // poses with no point in the interior

 private:
  field::ContactProbe& probe_;
};

// The guard by construction: whatever the hand does, the pose that is kept is one that was looked
// up and found clear, bit for bit.
TEST(DefaultModel, KeepsOnlyPosesThatWereLookedUpAndClear) {
  const std::uint64_t seed = 20240612;
  SCOPED_TRACE(seed);
  std::mt19937_64 random(seed);
  const Pose start = at(glm::dvec3(3, 2, 14) * kS);
  MotionBench bench(floor_scene(kS), box_part(glm::dvec3(4, 2, 1.5) * kS, kS, kS), start);
  const model::Simulation& simulation = *bench.simulation;
  query::ContactQuery query(simulation.voxmap(), simulation.shell(), {});
  const auto field =
      field::make_force_field(Model::kDefault, ForceKind::kLevel, simulation.voxmap());
  ASSERT_TRUE(field);
  query::CollectedPoints points;
  field::FieldSamples samples;
  points.reserve(simulation.shell().view().point_count);
  samples.reserve(simulation.shell().view().point_count);
  field::ContactSet looked_up;
  looked_up.reserve(simulation.shell().view().point_count);
  guard::PoseGuard probe(query, **field, points, samples);
  WatchedProbe watched(probe);
  model::DefaultModel model(simulation.parameters(), watched,
                            simulation.shell().view().point_count);
  State state = bench.state;
  StepInput input = bench.input;
  Pose goal = start;
  std::uint32_t touching = 0;
  for (int frame = 0; frame < 20000; ++frame) {
    if (frame % 200 == 0) {
      goal = {start.position_m + random_direction(random) * uniform(random, 0, 20) * kS,
              random_orientation(random)};
    }
    Pose& handle = input.world_from_handle;
    const double fraction = frame % 3000 < 100 ? 1 : 0.03;
    handle.position_m += fraction * (goal.position_m - handle.position_m);
    handle.orientation = glm::normalize(glm::slerp(handle.orientation, goal.orientation, fraction));
    const Pose before = state.world_from_center;
    watched.clear.clear();
    const StepResult result = model.step(state, input, 0.001);
    const auto same = [&](const Pose& pose) {
      return std::memcmp(&pose, &state.world_from_center, sizeof(Pose)) == 0;
    };
    ASSERT_TRUE(same(before) || std::any_of(watched.clear.begin(), watched.clear.end(), same))
        << frame;
    ASSERT_TRUE(same(result.report.world_from_center)) << frame;
    touching += result.report.contacts > 0;
    probe.query_pose(result.report.world_from_center, looked_up);
    double deepest_m = 0;
    for (std::uint32_t i = 0; i < looked_up.count; ++i) {
      deepest_m = std::max(deepest_m, double{looked_up.depth_m[i]});
    }
    ASSERT_EQ(result.report.depth_m, deepest_m) << frame;
  }
  EXPECT_GT(touching, 1000u);
}

}  // namespace
}  // namespace forcelayer::test

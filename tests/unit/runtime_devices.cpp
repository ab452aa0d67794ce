// Motion scripts, the placement of the device, and the handle's velocity.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>

#include "runtime/coupling.h"
#include "runtime/devices/sim_device.h"
#include "runtime/handle_velocity.h"
#include "runtime/input_source.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::test {
namespace {

constexpr const char* kHeader = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";

Result<MotionScript> read_text(const std::string& text) {
  const ScratchFolder folder;
  std::ofstream(folder / "motion.csv") << text;
  return MotionScript::read(folder / "motion.csv");
}

TEST(MotionScript, GoesStraightAndTurnsEvenly) {
  const auto script = read_text(std::string(kHeader) + "1,0,0,0,1,0,0,0\r\n3,1,2,-4,0,0,0,2\r\n");
  ASSERT_TRUE(script);
  EXPECT_EQ(script->end_s(), 3);
  EXPECT_EQ(script->pose(0).position_m, glm::dvec3(0));
  const Pose middle = script->pose(2);
  EXPECT_LT(glm::length(middle.position_m - glm::dvec3(0.5, 1, -2)), 1e-15);
  EXPECT_LT(glm::length(rotation_vector(middle.orientation) - glm::dvec3(0, 0, M_PI / 2)), 1e-14);
  EXPECT_LT(glm::length(script->velocity(2).linear_mps - glm::dvec3(0.5, 1, -2)), 1e-15);
  EXPECT_LT(glm::length(script->velocity(2).angular_radps - glm::dvec3(0, 0, M_PI / 2)), 1e-14);
  EXPECT_EQ(script->velocity(0.5).linear_mps, glm::dvec3(0));
  EXPECT_EQ(script->velocity(3).linear_mps, glm::dvec3(0));
  EXPECT_EQ(script->pose(99).position_m, glm::dvec3(1, 2, -4));
}

TEST(MotionScript, NamesTheLineThatIsWrong) {
  const struct {
    const char *text, *where;
  } cases[] = {
      {"", "line 1"},
      {"t,x\n", "line 1"},
      {"t_s,x_m,y_m,z_m,qw,qx,qy,qz\n", "line 2"},
      {"t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0\n", "line 2"},
      {"t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0,9\n", "line 2"},
      {"t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,nan,0,1,0,0,0\n", "line 2"},
      {"t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,0,0,0,0\n", "line 2"},
      {"t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,0,1,0,0,0\n0,0,0,0,1,0,0,0\n", "line 3"},
      {"t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0;0;0,1,0,0,0\n", "line 2"},
  };
  for (const auto& c : cases) {
    const auto script = read_text(c.text);
    ASSERT_FALSE(script) << c.text;
    EXPECT_EQ(script.error().code, ErrorCode::kUsage) << c.text;
    EXPECT_EQ(script.error().where, c.where) << c.text;
  }
  EXPECT_EQ(MotionScript::read("/nowhere/motion.csv").error().code, ErrorCode::kFileNotFound);
}

TEST(Placement, ThereAndBackIsTheSamePose) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    DevicePlacement placement;
    placement.world_from_device = {random_direction(random), random_orientation(random)};
    placement.motion_scale = uniform(random, 0.1, 10);
    const Pose handle{random_direction(random), random_orientation(random)};
    const Pose back = placement.device_from_handle(placement.world_from_handle(handle));
    EXPECT_LT(glm::length(back.position_m - handle.position_m), 1e-13) << "seed " << seed;
    EXPECT_LT(glm::length(rotation_vector(back.orientation * glm::conjugate(handle.orientation))),
              1e-14)
        << "seed " << seed;
  }
}

// Carrying the wrench to the grip and the velocity to the point are each other's transpose.
TEST(Placement, KeepsThePowerAtTheHandle) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    DevicePlacement placement;
    placement.world_from_device = {random_direction(random), random_orientation(random)};
    const Wrench on_hand{random_direction(random), random_direction(random)};
    const Twist device{random_direction(random), random_direction(random)};
    const Twist world = placement.world_twist(device);
    const glm::dvec3 handle_m = random_direction(random), point_m = random_direction(random);
    const Wrench felt = placement.device_wrench(on_hand, point_m, handle_m);
    const glm::dvec3 point_mps =
        world.linear_mps + glm::cross(world.angular_radps, point_m - handle_m);
    const double power_w =
        glm::dot(on_hand.force_n, point_mps) + glm::dot(on_hand.torque_nm, world.angular_radps);
    EXPECT_NEAR(
        glm::dot(felt.force_n, device.linear_mps) + glm::dot(felt.torque_nm, device.angular_radps),
        power_w, 1e-13)
        << "seed " << seed;
  }
}

TEST(SimDevice, FollowsTheScriptInWorldPosesWhereverItIsPlaced) {
  DevicePlacement placement;
  placement.world_from_device = {{5, -2, 1}, rotation_by({0.3, 0.4, 0.5})};
  placement.motion_scale = 4;
  const auto script = read_text(std::string(kHeader) + "0,0,0,0,1,0,0,0\n1,0.1,0,0,1,0,0,0\n");
  ASSERT_TRUE(script);
  SimDevice device(*script, placement);
  DeviceInput input(device, placement);
  StepInput step;
  ASSERT_TRUE(input.next(0.5, 0.001, step));
  EXPECT_EQ(step.valid, 1u);
  EXPECT_LT(glm::length(step.world_from_handle.position_m - glm::dvec3(0.05, 0, 0)), 1e-14);
  EXPECT_LT(glm::length(step.handle_velocity.linear_mps - glm::dvec3(0.1, 0, 0)), 1e-14);
}

TEST(HandleVelocity, FollowsAMotionAndStaysSmallForEncoderSteps) {
  HandleVelocity estimate;
  Pose pose;
  Twist v;
  for (int i = 0; i < 100; ++i) {
    pose.position_m.x = 0.0002 * i;
    v = estimate.update(pose, 0.001);
  }
  EXPECT_NEAR(v.linear_mps.x, 0.2, 1e-6);
  estimate.reset();
  double largest = 0;
  for (int i = 0; i < 1000; ++i) {
    pose.position_m.x = (i / 10) % 2 ? 25e-6 : 0;  // one encoder step back and forth
    largest = std::max(largest, std::abs(estimate.update(pose, 0.001).linear_mps.x));
  }
  EXPECT_LE(largest, 25e-6 / HandleVelocity::kTimeConstantS);
}

TEST(HandleVelocity, AJumpIsNoMotion) {
  HandleVelocity estimate;
  Pose pose;
  estimate.update(pose, 0.001);
  pose.position_m.x = 0.02;  // 20 m/s
  EXPECT_EQ(estimate.update(pose, 0.001).linear_mps, glm::dvec3(0));
}

}  // namespace
}  // namespace forcelayer::test

// Motion scripts, the placement of the device, and the handle's velocity.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"
#include "runtime/devices/sim_device.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/loop/input_source.h"
#include "tests/support/address_limit.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer::test {
namespace {

constexpr const char* kHeader = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";

Result<devices::MotionScript> read_text(const std::string& text) {
  const ScratchFolder folder;
  std::ofstream(folder / "motion.csv") << text;
  return devices::MotionScript::read(folder / "motion.csv");
}

TEST(MotionScript, GoesStraightAndTurnsEvenly) {
  const auto script = read_text(std::string(kHeader) + "1,0,0,0,1,0,0,0\r\n3,1,2,-4,0,0,0,2\r\n");
  ASSERT_TRUE(script);
  EXPECT_EQ(script->end_s(), 3);
  EXPECT_EQ(script->pose(0).position_m, glm::dvec3(0));
  const Pose middle = script->pose(2);
  EXPECT_LT(glm::length(middle.position_m - glm::dvec3(0.5, 1, -2)), 1e-15);
  EXPECT_LT(glm::length(coupling::rotation_vector(middle.orientation) - glm::dvec3(0, 0, M_PI / 2)),
            1e-14);
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
  EXPECT_EQ(devices::MotionScript::read("/nowhere/motion.csv").error().code,
            ErrorCode::kFileNotFound);
}

// Small files of every kind: every way to end the last line, every place to cut a file at.
TEST(MotionScript, SmallFilesAreReadWholeOrRefused) {
  const std::string header(kHeader), row = "0,1,2,3,1,0,0,0", next = "1,4,5,6,1,0,0,0";
  for (const std::string end : {"", "\n", "\r\n", "\n\n", "\r", "\n\r\n"}) {
    const auto one = read_text(header + row + end);
    ASSERT_TRUE(one) << end;
    EXPECT_EQ(one->end_s(), 0);
    EXPECT_EQ(one->pose(7).position_m, glm::dvec3(1, 2, 3));
    EXPECT_EQ(one->velocity(0).linear_mps, glm::dvec3(0));
    const auto two = read_text(header + row + '\n' + next + end);
    ASSERT_TRUE(two) << end;
    EXPECT_EQ(two->end_s(), 1);
    EXPECT_EQ(two->pose(1).position_m, glm::dvec3(4, 5, 6));
  }
  const std::string whole = header + row + '\n' + next + '\n';
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    const auto cut = read_text(whole.substr(0, bytes));
    // Without its end the last line is no row, or one with the last number cut: these end in "0".
    const std::size_t first_end = header.size() + row.size(), second_end = whole.size() - 1;
    const bool sound = bytes == first_end || bytes == first_end + 1 || bytes == second_end;
    EXPECT_EQ(cut.ok(), sound) << whole.substr(0, bytes);
    if (!cut) {
      EXPECT_EQ(cut.error().code, ErrorCode::kUsage);
    }
  }
  EXPECT_FALSE(read_text(header + row + std::string(1, '\0')));
  EXPECT_FALSE(read_text(std::string(1, '\0') + header + row));
  EXPECT_TRUE(read_text("\xef\xbb\xbf" + header + row));  // the mark of UTF-8
  // A line of 4096 bytes is read, blanks and all; a longer one is refused before it is held.
  const auto padded = [&](std::size_t bytes) {
    return header + std::string(bytes - row.size(), ' ') + row + '\n';
  };
  EXPECT_TRUE(read_text(padded(4096)));
  const auto longer = read_text(padded(4097));
  ASSERT_FALSE(longer);
  EXPECT_NE(longer.error().what.find("4096"), std::string::npos);
  const AddressLimit limit(std::uint64_t{64} << 20);
  EXPECT_FALSE(devices::MotionScript::read("/dev/zero"));
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
    EXPECT_LT(glm::length(
                  coupling::rotation_vector(back.orientation * glm::conjugate(handle.orientation))),
              1e-14)
        << "seed " << seed;
  }
}

// The scale is a transformer: force and velocity, and torque and turning, are each other's
// transpose.
TEST(Placement, WorkAtTheDeviceIsWorkInTheScene) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    DevicePlacement placement;
    placement.world_from_device = {random_direction(random), random_orientation(random)};
    placement.motion_scale = uniform(random, 0.1, 10);
    const Wrench on_hand{random_direction(random), random_direction(random)};
    const Twist device{random_direction(random), random_direction(random)};
    const Twist world = placement.world_twist(device), back = placement.device_twist(world);
    EXPECT_LT(glm::length(back.linear_mps - device.linear_mps), 3e-15) << "seed " << seed;
    EXPECT_LT(glm::length(back.angular_radps - device.angular_radps), 3e-15) << "seed " << seed;
    const Wrench felt = placement.device_wrench(on_hand);
    EXPECT_NEAR(glm::length(felt.torque_nm), glm::length(on_hand.torque_nm), 1e-15);
    const double power_w = glm::dot(on_hand.force_n, world.linear_mps) +
                           glm::dot(on_hand.torque_nm, world.angular_radps);
    EXPECT_NEAR(
        glm::dot(felt.force_n, device.linear_mps) + glm::dot(felt.torque_nm, device.angular_radps),
        power_w, 1e-14)
        << "seed " << seed;
  }
}

TEST(SimDevice, FollowsTheScriptInWorldPosesWhereverItIsPlaced) {
  DevicePlacement placement;
  placement.world_from_device = {{5, -2, 1}, coupling::rotation_by({0.3, 0.4, 0.5})};
  placement.motion_scale = 4;
  const auto script = read_text(std::string(kHeader) + "0,0,0,0,1,0,0,0\n1,0.1,0,0,1,0,0,0\n");
  ASSERT_TRUE(script);
  devices::SimDevice device(*script, placement);
  loop::DeviceInput input(device, placement);
  StepInput step;
  ASSERT_TRUE(input.next(0.5, 0.001, step));
  EXPECT_EQ(step.valid, 1u);
  EXPECT_LT(glm::length(step.world_from_handle.position_m - glm::dvec3(0.05, 0, 0)), 1e-14);
  EXPECT_LT(glm::length(step.handle_velocity.linear_mps - glm::dvec3(0.1, 0, 0)), 1e-14);
}

TEST(HandleVelocity, FollowsAMotionAndStaysSmallForEncoderSteps) {
  loop::HandleVelocity estimate;
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
  EXPECT_LE(largest, 25e-6 / loop::HandleVelocity::kTimeConstantS);
}

TEST(HandleVelocity, AJumpIsNoMotion) {
  loop::HandleVelocity estimate;
  Pose pose;
  estimate.update(pose, 0.001);
  pose.position_m.x = 0.02;  // 20 m/s
  EXPECT_EQ(estimate.update(pose, 0.001).linear_mps, glm::dvec3(0));
}

}  // namespace
}  // namespace forcelayer::test

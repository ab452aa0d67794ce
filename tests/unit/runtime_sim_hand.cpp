// The simulated hand and device against closed forms.
#include "runtime/devices/sim_hand.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"
#include "runtime/devices/sim_device.h"

namespace forcelayer::test {
namespace {

constexpr double kDtS = 0.001;

const Pose kHome{{0.1, -0.2, 0.3}, {0.8, 0, 0.6, 0}};

glm::dvec3 turned_by(const Pose& from, const Pose& to) {
  return coupling::rotation_vector(to.orientation * glm::conjugate(from.orientation));
}

// Without friction, steps and delay.
devices::SimHandParameters ideal() {
  devices::SimHandParameters p;
  p.device_friction_n = p.device_friction_nm = 0;
  p.encoder_step_m = p.encoder_step_rad = 0;
  p.force_step_n = p.torque_step_nm = 0;
  p.delay_s = 0;
  return p;
}

// The hand gives way by force over stiffness and torque over stiffness, within the steps and what
// friction holds.
TEST(SimHand, GivesWayByForceOverStiffness) {
  const devices::SimHandParameters p;
  devices::SimHand hand(p, kHome);
  const Wrench push{{3, -1, 2}, {0.02, 0.05, -0.03}};
  for (int frame = 0; frame < 3000; ++frame) hand.step(kHome, push, kDtS);
  const glm::dvec3 way_m = hand.pose().position_m - kHome.position_m;
  EXPECT_LT(glm::length(way_m - push.force_n / p.hand_stiffness_n_per_m),
            (p.device_friction_n + p.force_step_n) / p.hand_stiffness_n_per_m);
  EXPECT_LT(
      glm::length(turned_by(kHome, hand.pose()) - push.torque_nm / p.hand_stiffness_nm_per_rad),
      (p.device_friction_nm + p.torque_step_nm) / p.hand_stiffness_nm_per_rad);
}

// Let go from a stretch, place and angle swing as damped oscillators do. The substep of 50 us
// leaves about h w = 0.2% (place) and 0.25% (angle) of the amplitude.
TEST(SimHand, SwingsAsADampedOscillator) {
  const devices::SimHandParameters p = ideal();
  const auto expected = [](double amplitude, double k, double b, double m, double t) {
    const double decay = b / (2 * m), w = std::sqrt(k / m - decay * decay);
    return amplitude * std::exp(-decay * t) * (std::cos(w * t) + decay / w * std::sin(w * t));
  };
  const glm::dvec3 axis = glm::normalize(glm::dvec3(1, 2, -2));
  const Pose start{kHome.position_m + 0.01 * axis,
                   coupling::rotation_by(0.1 * axis) * kHome.orientation};
  devices::SimHand hand(p, start);
  for (int frame = 1; frame <= 200; ++frame) {
    hand.step(kHome, {}, kDtS);
    const double t = frame * kDtS;
    const double place = expected(0.01, p.hand_stiffness_n_per_m,
                                  p.hand_damping_ns_per_m + p.device_damping_ns_per_m,
                                  p.hand_mass_kg + p.device_mass_kg, t);
    const double angle = expected(0.1, p.hand_stiffness_nm_per_rad,
                                  p.hand_damping_nms_per_rad + p.device_damping_nms_per_rad,
                                  p.hand_inertia_kgm2 + p.device_inertia_kgm2, t);
    EXPECT_LT(glm::length(hand.pose().position_m - kHome.position_m - place * axis), 0.01 * 0.01);
    EXPECT_LT(glm::length(turned_by(kHome, hand.pose()) - angle * axis), 0.01 * 0.1);
  }
}

TEST(SimHand, FeelsTheLoopOneDelayLate) {
  for (const double delay_s : {0.0, 0.001, 0.003}) {
    devices::SimHandParameters p = ideal();
    p.delay_s = delay_s;
    devices::SimHand hand(p, kHome);
    const Wrench push{{5, 0, 0}, {0, 0.05, 0}};
    for (int frame = 1; frame <= 6; ++frame) {
      hand.step(kHome, push, kDtS);
      const bool late = frame * kDtS <= delay_s + 1e-9;
      EXPECT_EQ(hand.pose().position_m == kHome.position_m, late) << delay_s << " " << frame;
      EXPECT_EQ(hand.pose().orientation == kHome.orientation, late) << delay_s << " " << frame;
    }
  }
}

// Encoder readings are whole numbers of steps, at most half a step an axis from the truth, on
// any axis and past half a turn.
TEST(SimHand, ReportsEncoderSteps) {
  devices::SimHandParameters p;
  p.encoder_step_m = 1e-4;
  p.encoder_step_rad = 1e-2;
  devices::SimHand hand(p, kHome);
  const glm::dvec3 axis = glm::normalize(glm::dvec3(-2, 1, 2));
  for (int frame = 0; frame < 4000; ++frame) {
    const double t = frame * kDtS;
    const Pose wanted{kHome.position_m + glm::dvec3(0.02 * t, 0, 0),
                      coupling::rotation_by(t * axis) * kHome.orientation};
    const Pose said = hand.step(wanted, {}, kDtS);
    for (int i = 0; i < 3; ++i) {
      const double steps = said.position_m[i] / p.encoder_step_m;
      EXPECT_NEAR(steps, std::round(steps), 1e-6);
    }
    EXPECT_LT(glm::length(said.position_m - hand.pose().position_m), 0.87 * p.encoder_step_m);
    EXPECT_LT(glm::length(turned_by(said, hand.pose())), 0.87 * p.encoder_step_rad + 1e-12);
  }
  EXPECT_GT(hand.pose().position_m.x, kHome.position_m.x + 0.07);  // it did move
}

TEST(SimHand, PullsNoHarderThanAHand) {
  devices::SimHandParameters p = ideal();
  p.hand_damping_ns_per_m = p.device_damping_ns_per_m = 0;
  devices::SimHand hand(p, kHome);
  Pose far = kHome;
  far.position_m.x += 10;
  for (int frame = 0; frame < 100; ++frame) hand.step(far, {}, kDtS);
  // 15 N on 0.5 kg for 0.1 s; half a substep of symplectic Euler.
  EXPECT_NEAR(hand.pose().position_m.x - kHome.position_m.x, 0.5 * 15 / 0.5 * 0.01, 1e-4);
}

TEST(SimHandDevice, FollowsItsScriptAndFeelsWhatIsWritten) {
  const DevicePlacement placement{{{1, 2, 3}, {0.8, 0.6, 0, 0}}, 2};
  devices::SimHandDevice device(devices::MotionScript({{0, kHome}}), placement,
                                devices::SimHandParameters());
  const Pose first = placement.world_from_handle(device.read(0).device_from_handle);
  EXPECT_LT(glm::length(first.position_m - kHome.position_m), 1e-12);
  EXPECT_FALSE(device.capabilities().senses_velocity);
  for (int frame = 1; frame < 2000; ++frame) {
    device.write({{0, 4, 0}, {0, 0, 0}});
    EXPECT_TRUE(device.read(frame * kDtS).present);
  }
  // 4 N over 400 N/m at the device, two meters of scene a meter of it, in the device's axes.
  const Pose last = placement.world_from_handle(device.read(2).device_from_handle);
  const glm::dvec3 way = glm::conjugate(placement.world_from_device.orientation) *
                         (last.position_m - kHome.position_m);
  EXPECT_NEAR(way.y, 2 * 0.01, 4e-4);
  EXPECT_LT(std::hypot(way.x, way.z), 1e-4);
}

}  // namespace
}  // namespace forcelayer::test

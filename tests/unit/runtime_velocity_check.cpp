// The velocity that a device may claim, and the poses that must bear it out.
#include "runtime/loop/velocity_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "runtime/coupling/coupling.h"

namespace forcelayer::test {
namespace {

// A hand on a Lissajous path: up to 2.5 m/s and 20 rad/s.
Pose hand_at(double t_s) {
  return {{0.2 * std::sin(10 * t_s), 0.1 * std::sin(13 * t_s), 0.05 * std::cos(7 * t_s)},
          coupling::rotation_by({1.2 * std::sin(12 * t_s), 0, 0.6 * std::sin(9 * t_s)})};
}

Twist velocity_at(double t_s) {
  constexpr double kStep = 1e-6;
  const Pose a = hand_at(t_s - kStep), b = hand_at(t_s + kStep);
  return {(b.position_m - a.position_m) / (2 * kStep),
          coupling::rotation_vector(b.orientation * glm::conjugate(a.orientation)) / (2 * kStep)};
}

struct Sensor {
  double period_s = 0.001;
  double lag_s = 0;      // of the velocity behind the pose
  double scale = 1;      // of the velocity
  double step_m = 0;     // of the encoders
  double noise_mps = 0;  // of the velocity
};

// Readings that were refused, of 5 s.
int refused(const Sensor& sensor) {
  loop::VelocityCheck check;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, 1);
  int refused = 0;
  const int readings = static_cast<int>(5 / sensor.period_s);
  for (int i = 0; i < readings; ++i) {
    const double t_s = i * sensor.period_s;
    Pose pose = hand_at(t_s);
    Twist claim = velocity_at(t_s - sensor.lag_s);
    claim.linear_mps *= sensor.scale;
    claim.angular_radps *= sensor.scale;
    for (int axis = 0; axis < 3; ++axis) {
      if (sensor.step_m > 0) {
        pose.position_m[axis] = std::round(pose.position_m[axis] / sensor.step_m) * sensor.step_m;
      }
      claim.linear_mps[axis] += noise(random) * sensor.noise_mps;
      claim.angular_radps[axis] += noise(random) * sensor.noise_mps * 10;
    }
    refused += check.believes(pose, claim, sensor.period_s) ? 0 : 1;
  }
  return refused;
}

TEST(VelocityCheck, BelievesSensorsAsTheyAre) {
  EXPECT_EQ(refused({}), 0);
  for (const double period_s : {0.00025, 0.001, 0.004, 0.01}) {
    EXPECT_EQ(refused({.period_s = period_s}), 0) << period_s;
    EXPECT_EQ(refused({.period_s = period_s, .lag_s = 0.005}), 0) << period_s;
  }
  EXPECT_EQ(refused({.scale = 1.2}), 0);
  EXPECT_EQ(refused({.step_m = 0.0005}), 0);
  EXPECT_EQ(refused({.noise_mps = 0.05}), 0);
}

TEST(VelocityCheck, RefusesOtherUnitsSignsAndScales) {
  for (const double scale : {1000.0, 57.3, 3.0, -1.0}) {
    EXPECT_GT(refused({.scale = scale}), 1000) << scale;
  }
}

TEST(VelocityCheck, AStillHandleClaimsNothing) {
  for (const double claim : {0.2, 10.0, 1e300, std::nan("")}) {
    for (const bool turns : {false, true}) {
      loop::VelocityCheck check;
      Twist twist;
      (turns ? twist.angular_radps : twist.linear_mps).x = turns ? 10 * claim : claim;
      EXPECT_TRUE(check.believes({}, twist, 0.001));  // nothing shows it yet
      int until = 0;
      while (check.believes({}, twist, 0.001) && until < 100) ++until;
      EXPECT_LT(until, 10) << claim << turns;
      EXPECT_TRUE(check.believes({}, {}, 0.001));  // a single one leaves nothing behind
    }
  }
}

}  // namespace
}  // namespace forcelayer::test

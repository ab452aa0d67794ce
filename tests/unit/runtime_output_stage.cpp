// Arming, limits and failing of the output.
#include "runtime/loop/output_stage.h"

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <limits>
#include <vector>

#include "runtime/devices/output_watch.h"

namespace forcelayer::test {
namespace {

constexpr double kDt = 0.001;

loop::OutputLimits limits() {
  loop::OutputLimits l;
  l.max_force_n = 10;
  l.max_torque_nm = 0.5;
  return l;
}

loop::OutputFrame frame(double force_n) {
  loop::OutputFrame f;
  f.wanted.force_n = {force_n, 0, 0};
  f.free_of_contact = true;
  return f;
}

// Zero for 20 ms once armed: a device's side that writes for milliseconds sees it all the same.
constexpr int kZeroFrames = 20;

void expect_zero(loop::OutputStage& stage, const loop::OutputFrame& frame, int frames) {
  for (int i = 0; i < frames; ++i) {
    const Wrench out = stage.pass(frame, kDt);
    EXPECT_EQ(out.force_n, glm::dvec3(0)) << i;
    EXPECT_EQ(out.torque_nm, glm::dvec3(0)) << i;
    EXPECT_TRUE(stage.at_zero());
  }
}

// A stage that has ramped in and holds `force_n`.
loop::OutputStage armed(double force_n) {
  loop::OutputStage stage(limits());
  for (int i = 0; i < 300; ++i) stage.pass(frame(force_n), kDt);
  EXPECT_EQ(stage.state(), OutputState::kArmed);
  return stage;
}

TEST(OutputStage, RampsInOver200Milliseconds) {
  loop::OutputStage stage(limits());
  expect_zero(stage, frame(4), kZeroFrames);  // from the frame that arms: OutputWatch wants it
  double last = 0;
  for (int i = 1; i <= 200; ++i) {
    const double x = stage.pass(frame(4), kDt).force_n.x;
    EXPECT_NEAR(x, 4 * i / 200.0, 1e-12);
    EXPECT_GE(x, last);
    last = x;
  }
  EXPECT_EQ(stage.pass(frame(4), kDt).force_n.x, 4);
}

TEST(OutputStage, DoesNotArmInAStretchedContact) {
  loop::OutputStage stage(limits());
  loop::OutputFrame f = frame(4);
  f.free_of_contact = false;
  for (int i = 0; i < 10; ++i) EXPECT_EQ(stage.pass(f, kDt).force_n.x, 0);
  EXPECT_EQ(stage.state(), OutputState::kWaiting);
  f.unstretched = true;
  expect_zero(stage, f, kZeroFrames);
  EXPECT_GT(stage.pass(f, kDt).force_n.x, 0);
}

TEST(OutputStage, NeverExceedsTheLimits) {
  loop::OutputStage stage = armed(1);
  loop::OutputFrame f = frame(0);
  f.wanted = {{300, -400, 0}, {0, 0, -7}};
  Wrench out;
  for (int i = 0; i < 50; ++i) {
    out = stage.pass(f, kDt);
    EXPECT_LE(glm::length(out.force_n), 10 * (1 + 1e-15));
    EXPECT_LE(glm::length(out.torque_nm), 0.5 * (1 + 1e-15));
  }
  EXPECT_NEAR(glm::length(out.force_n - glm::dvec3(6, -8, 0)), 0, 1e-12);
}

TEST(OutputStage, LimitsHowFastTheOutputRisesButNotHowFastItVanishes) {
  loop::OutputStage stage = armed(0);
  EXPECT_NEAR(stage.pass(frame(10), kDt).force_n.x, 2, 1e-12);  // 10 N in 5 ms
  EXPECT_NEAR(stage.pass(frame(10), kDt).force_n.x, 4, 1e-12);
  EXPECT_EQ(stage.pass(frame(0), kDt).force_n.x, 0);
}

TEST(OutputStage, ASingleFaultyFrameIsABlipAndRampsInAnew) {
  loop::OutputStage stage = armed(1);
  loop::OutputFrame f = frame(0);
  f.faulty = true;
  expect_zero(stage, f, 1);
  EXPECT_EQ(stage.state(), OutputState::kArmed);
  expect_zero(stage, frame(1), kZeroFrames - 1);
  for (int i = 1; i <= 200; ++i) {
    EXPECT_NEAR(stage.pass(frame(1), kDt).force_n.x, i / 200.0, 1e-12);
  }
  EXPECT_EQ(stage.trips(), 0u);
}

TEST(OutputStage, AHandThatTurnsTooFastTrips) {
  loop::OutputStage stage = armed(1);
  loop::OutputFrame f = frame(1);
  f.turn_radps = 49;
  EXPECT_EQ(stage.pass(f, kDt).force_n.x, 1);
  f.turn_radps = 1e300;
  EXPECT_EQ(stage.pass(f, kDt).force_n.x, 0);
  EXPECT_EQ(stage.last_trip(), TripCause::kOverSpeed);
}

// A device without torques is asked for none, however small: its side takes any for a wild write.
TEST(OutputStage, ALimitOfZeroLetsNothingThrough) {
  loop::OutputLimits l = limits();
  l.max_torque_nm = 0;
  loop::OutputStage stage(l);
  for (const double torque : {1e-157, 1e-300, 5e-324, 1.0}) {
    loop::OutputFrame f = frame(1);
    f.wanted.torque_nm = {0, torque, 0};
    for (int i = 0; i < 300; ++i) EXPECT_EQ(stage.pass(f, kDt).torque_nm, glm::dvec3(0)) << torque;
    EXPECT_EQ(stage.pass(f, kDt).force_n.x, 1) << torque;
  }
}

// Invalid limits, as a damaged recording has them, let nothing through.
TEST(OutputStage, ChecksItsOwnResultLast) {
  loop::OutputLimits l = limits();
  l.max_force_n = -10;
  loop::OutputStage stage(l);
  expect_zero(stage, frame(4), 400);
  EXPECT_EQ(stage.last_trip(), TripCause::kNotFinite);
}

TEST(OutputStage, LastingFaultsTripAndArmAgainWithARamp) {
  loop::OutputLimits l = limits();
  l.rearm_alone = true;
  loop::OutputStage stage(l);
  for (int i = 0; i < 300; ++i) stage.pass(frame(1), kDt);
  loop::OutputFrame f = frame(0);
  f.faulty = true;
  for (int i = 0; i < 7; ++i) EXPECT_EQ(stage.pass(f, kDt).force_n.x, 0);
  EXPECT_EQ(stage.state(), OutputState::kTripped);
  EXPECT_EQ(stage.last_trip(), TripCause::kFrozen);
  expect_zero(stage, frame(1), kZeroFrames);
  EXPECT_NEAR(stage.pass(frame(1), kDt).force_n.x, 1 / 200.0, 1e-12);
}

TEST(OutputStage, TheZeroIsATimeAndNotANumberOfFrames) {
  for (const auto& [dt_s, frames] : {std::pair{0.05, 1}, {0.01, 2}, {0.00025, 80}}) {
    loop::OutputStage stage(limits());
    for (int i = 0; i < frames; ++i) EXPECT_EQ(stage.pass(frame(1), dt_s).force_n.x, 0) << dt_s;
    EXPECT_GT(stage.pass(frame(1), dt_s).force_n.x, 0) << dt_s;
  }
}

// A device's side whose writes take 14 ms takes every so many frames what is newest. It never
// gets stuck at its own zero, whenever the output arms or trips and arms again.
TEST(OutputStage, ADevicesSideThatIsSlowSeesTheZero) {
  for (int first = 0; first < 14; ++first) {
    loop::OutputLimits l = limits();
    l.rearm_alone = true;
    loop::OutputStage stage(l);
    devices::OutputWatch watch;
    double felt_n = 0;
    int latched_frames = 0;
    for (int i = 0; i < 2000; ++i) {
      loop::OutputFrame f = frame(1);
      if (i % 700 == 350) f.health.loop_late = true;  // trips, and arms again in the next frame
      const Wrench out = stage.pass(f, kDt);
      const std::int64_t now_ns = (i + 1) * 1'000'000LL;
      if (f.health.loop_late) watch.latch();  // its own side let go as well
      if (i % 14 != first) continue;
      felt_n = watch.pass(out, now_ns, now_ns).force_n.x;
      latched_frames += watch.latched() ? 1 : 0;
    }
    EXPECT_EQ(felt_n, 1) << first;
    EXPECT_LE(latched_frames, 4) << first;
  }
}

TEST(OutputStage, WhatIsNotFiniteNeverPasses) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    loop::OutputStage stage = armed(1);
    loop::OutputFrame f = frame(0);
    f.wanted.torque_nm.y = bad;
    const Wrench out = stage.pass(f, kDt);
    EXPECT_EQ(out.force_n, glm::dvec3(0));
    EXPECT_EQ(out.torque_nm, glm::dvec3(0));
    EXPECT_EQ(stage.last_trip(), TripCause::kNotFinite);
  }
}

TEST(OutputStage, AHandTooFastTripsAndStaysTripped) {
  loop::OutputStage stage = armed(1);
  loop::OutputFrame f = frame(1);
  f.speed_mps = 6;
  EXPECT_EQ(stage.pass(f, kDt).force_n.x, 0);
  EXPECT_EQ(stage.last_trip(), TripCause::kOverSpeed);
  for (int i = 0; i < 300; ++i) EXPECT_EQ(stage.pass(frame(1), kDt).force_n.x, 0);
  EXPECT_EQ(stage.trips(), 1u);
}

loop::OutputFrame with_trouble(InputTrouble trouble) {
  loop::OutputFrame f = frame(1);
  f.faulty = true;
  f.health.trouble = trouble;
  return f;
}

struct BadFrame {
  loop::OutputFrame frame;
  TripCause cause;
};

// Frames in which the device is lost, each with the cause of its trip.
std::vector<BadFrame> lost_frames() {
  return {{with_trouble(InputTrouble::kDeviceLost), TripCause::kDeviceLost},
          {with_trouble(InputTrouble::kNotCalibrated), TripCause::kNotCalibrated},
          {with_trouble(InputTrouble::kFrozen), TripCause::kFrozen}};
}

// Frames with a fault that passes, of the loop, the hand or the wrench.
std::vector<BadFrame> passing_frames() {
  loop::OutputFrame late = frame(1), held = frame(1), fast = frame(1);
  late.health.loop_late = true;
  held.health.output_held = true;
  fast.speed_mps = 6;
  return {
      {late, TripCause::kLoopLate}, {held, TripCause::kOutputHeld}, {fast, TripCause::kOverSpeed}};
}

TEST(OutputStage, EachCauseTripsInItsFrameAndIsNamed) {
  std::vector<BadFrame> cases = lost_frames();
  for (const BadFrame& more : passing_frames()) cases.push_back(more);
  for (const auto& [bad, cause] : cases) {
    loop::OutputStage stage = armed(1);
    EXPECT_EQ(stage.pass(bad, kDt).force_n.x, 0) << to_text(cause);
    EXPECT_EQ(stage.state(), OutputState::kTripped) << to_text(cause);
    EXPECT_EQ(stage.last_trip(), cause);
    for (int i = 0; i < 300; ++i) EXPECT_EQ(stage.pass(frame(1), kDt).force_n.x, 0);
  }
}

// It waits for the hand to lift the part, not for a device that is gone.
TEST(OutputStage, WhatIsLostTripsAWaitingOutputToo) {
  loop::OutputFrame stretched = frame(1);
  stretched.free_of_contact = false;
  const auto waiting = [&] {
    loop::OutputStage stage(limits());
    expect_zero(stage, stretched, 10);
    EXPECT_EQ(stage.state(), OutputState::kWaiting);
    return stage;
  };
  for (auto [bad, cause] : lost_frames()) {
    loop::OutputStage stage = waiting();
    bad.free_of_contact = false;
    expect_zero(stage, bad, 1);
    EXPECT_EQ(stage.state(), OutputState::kTripped) << to_text(cause);
    EXPECT_EQ(stage.last_trip(), cause);
    expect_zero(stage, frame(1), 300);
    EXPECT_EQ(stage.trips(), 1u);
  }
  for (auto [bad, cause] : passing_frames()) {
    loop::OutputStage stage = waiting();
    bad.free_of_contact = cause != TripCause::kOutputHeld;  // held by its own side: it may arm
    expect_zero(stage, bad, 300);
    EXPECT_EQ(stage.state(), OutputState::kWaiting) << to_text(cause);
    expect_zero(stage, frame(1), kZeroFrames);
    EXPECT_GT(stage.pass(frame(1), kDt).force_n.x, 0);
  }
  // Nonsense is a blip at first, and no late loop hides it.
  loop::OutputFrame overflowed = frame(0);
  overflowed.faulty = overflowed.not_finite = true;
  for (auto [nonsense, cause] :
       {BadFrame{with_trouble(InputTrouble::kNotFinite), TripCause::kInputNotFinite},
        BadFrame{with_trouble(InputTrouble::kImplausible), TripCause::kImplausible},
        BadFrame{overflowed, TripCause::kNotFinite}}) {
    loop::OutputStage stage = waiting();
    nonsense.health.loop_late = true;
    expect_zero(stage, nonsense, 5);
    EXPECT_EQ(stage.state(), OutputState::kWaiting);
    expect_zero(stage, nonsense, 1);
    EXPECT_EQ(stage.last_trip(), cause);
  }
}

TEST(OutputStage, NonsenseTripsAfterTheStaleLimit) {
  for (const auto& [trouble, cause] :
       {std::pair{InputTrouble::kNotFinite, TripCause::kInputNotFinite},
        std::pair{InputTrouble::kImplausible, TripCause::kImplausible}}) {
    loop::OutputStage stage = armed(1);
    const loop::OutputFrame f = with_trouble(trouble);
    for (int i = 0; i < 5; ++i) {
      EXPECT_EQ(stage.pass(f, kDt).force_n.x, 0);
      EXPECT_EQ(stage.state(), OutputState::kArmed);
    }
    stage.pass(f, kDt);
    EXPECT_EQ(stage.last_trip(), cause);
  }
}

// The trip names the lost device, and not the nonsense before it.
TEST(OutputStage, ALostDeviceIsNamedAfterNonsense) {
  loop::OutputStage stage = armed(1);
  expect_zero(stage, with_trouble(InputTrouble::kNotFinite), 5);
  expect_zero(stage, with_trouble(InputTrouble::kDeviceLost), 1);
  EXPECT_EQ(stage.last_trip(), TripCause::kDeviceLost);
}

TEST(OutputStage, AReadingThatGrowsOldFades) {
  loop::OutputStage stage = armed(1);
  loop::OutputFrame f = frame(1);
  for (const auto& [age, force] : {std::pair{0.2f, 1.0}, {0.4f, 1.0}, {0.7f, 0.5}, {1.0f, 0.0}}) {
    f.health.age_fraction = age;
    EXPECT_NEAR(stage.pass(f, kDt).force_n.x, force, 1e-6) << age;  // the age is a float
  }
}

TEST(OutputStage, TheClutchFadesOutAndRampsBackIn) {
  loop::OutputStage stage = armed(1);
  loop::OutputFrame f = frame(1);
  f.health.clutch = true;
  for (int i = 1; i <= 50; ++i) {
    EXPECT_NEAR(stage.pass(f, kDt).force_n.x, 1 - i / 50.0, 1e-12);
  }
  EXPECT_TRUE(stage.at_zero());
  for (int i = 1; i <= 200; ++i) {
    EXPECT_NEAR(stage.pass(frame(1), kDt).force_n.x, i / 200.0, 1e-12);
  }
  EXPECT_EQ(stage.trips(), 0u);
}

// Nobody's hand says that it is ready when another thread loads a scene.
TEST(OutputStage, ASwapFadesLikeTheClutchButArmsNothing) {
  loop::OutputStage stage = armed(1);
  loop::OutputFrame f = frame(1);
  f.health.swapping = true;
  for (int i = 1; i <= 50; ++i) EXPECT_NEAR(stage.pass(f, kDt).force_n.x, 1 - i / 50.0, 1e-12);
  EXPECT_TRUE(stage.at_zero());
  EXPECT_NEAR(stage.pass(frame(1), kDt).force_n.x, 1 / 200.0, 1e-12);

  loop::OutputFrame gone = with_trouble(InputTrouble::kDeviceLost);
  stage.pass(gone, kDt);
  ASSERT_EQ(stage.state(), OutputState::kTripped);
  for (int i = 0; i < 300; ++i) EXPECT_EQ(stage.pass(f, kDt).force_n.x, 0);
  for (int i = 0; i < 300; ++i) EXPECT_EQ(stage.pass(frame(1), kDt).force_n.x, 0);
  EXPECT_EQ(stage.state(), OutputState::kTripped);
}

TEST(OutputStage, TheClutchArmsATrippedOutputButNotWhileTheCauseLasts) {
  loop::OutputStage stage = armed(1);
  loop::OutputFrame gone = with_trouble(InputTrouble::kDeviceLost);
  stage.pass(gone, kDt);
  gone.health.clutch = true;
  stage.pass(gone, kDt);
  EXPECT_EQ(stage.state(), OutputState::kTripped);
  loop::OutputFrame pressed = frame(1);
  pressed.free_of_contact = false;
  pressed.health.clutch = true;
  expect_zero(stage, pressed, kZeroFrames);
  EXPECT_EQ(stage.state(), OutputState::kArmed);
  EXPECT_NEAR(stage.pass(frame(1), kDt).force_n.x, 1 / 200.0, 1e-12);
}

}  // namespace
}  // namespace forcelayer::test

// The output of a device's I/O side while the loop is late.
#include "runtime/devices/output_watch.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

namespace forcelayer::test {
namespace {

const Wrench kPush{{3, 0, 0}, {0, 0.1, 0}};
constexpr std::int64_t kUs = 1000;

// The wrench on the motors `age_us` after the loop wrote it, at a time of its own for each pass.
class Watched {
 public:
  explicit Watched(double stale_s = kStaleLimitS) : watch(stale_s) {}
  Wrench pass(const Wrench& newest, std::int64_t age_us) {
    now_ns_ += 1000 * kUs;
    return watch.pass(newest, now_ns_ - age_us * kUs, now_ns_);
  }
  devices::OutputWatch watch;

 private:
  std::int64_t now_ns_ = 1'000'000'000;
};

TEST(OutputWatch, GivesNothingBeforeTheLoopsFirstZero) {
  Watched motors;
  EXPECT_EQ(motors.pass(kPush, 0).force_n.x, 0);
  EXPECT_EQ(motors.pass({}, 0).force_n.x, 0);
  EXPECT_EQ(motors.pass(kPush, 0).force_n.x, 3);
  EXPECT_EQ(motors.watch.falls(), 0);
}

TEST(OutputWatch, HoldsFadesAndLatches) {
  Watched motors;
  motors.pass({}, 0);
  EXPECT_EQ(motors.pass(kPush, 1500).force_n.x, 3);
  EXPECT_NEAR(motors.pass(kPush, 3500).force_n.x, 1.5, 1e-12);
  EXPECT_NEAR(motors.pass(kPush, 3500).torque_nm.y, 0.05, 1e-12);
  EXPECT_NEAR(motors.watch.falls(), 0.5, 1e-12);
  EXPECT_EQ(motors.pass(kPush, 5100).force_n.x, 0);
  EXPECT_TRUE(motors.watch.latched());
  EXPECT_NEAR(motors.watch.falls(), 1, 1e-12);
  EXPECT_EQ(motors.pass(kPush, 0).force_n.x, 0);  // the loop is back, but has not begun anew
  EXPECT_EQ(motors.pass({}, 6000).force_n.x, 0);
  EXPECT_EQ(motors.pass(kPush, 0).force_n.x, 0);  // an old zero tells nothing of the loop now
  motors.pass({}, 0);
  EXPECT_EQ(motors.pass(kPush, 0).force_n.x, 3);
  EXPECT_NEAR(motors.watch.falls(), 1, 1e-12);
}

// A loop that comes back in time finds the force where the fade left it.
TEST(OutputWatch, WhatItFadedItRampsInAgain) {
  Watched motors;
  motors.pass({}, 0);
  motors.pass(kPush, 0);
  double force = motors.pass(kPush, 4700).force_n.x;
  EXPECT_NEAR(force, 0.3, 1e-12);
  for (int ms = 1; ms <= 1000; ++ms) {
    const double missing = 3 - force;
    force = motors.pass(kPush, 0).force_n.x;
    EXPECT_LE(3 - force, missing);
    EXPECT_GE(3 - force, missing * 50 / 51 - 3.1e-6) << ms;  // of 50 ms, a 51st in the next 1 ms
  }
  EXPECT_EQ(force, 3);
  EXPECT_NEAR(motors.watch.falls(), 0.9, 1e-12);
  motors.pass(kPush, 4700);
  motors.pass({}, 0);  // from a zero of the loop on, the loop ramps
  EXPECT_EQ(motors.pass(kPush, 0).force_n.x, 3);
}

// A side that stood still itself, too.
TEST(OutputWatch, NoPassRampsForMoreThanAPeriod) {
  devices::OutputWatch watch;
  watch.pass({}, 0, 0);
  watch.pass(kPush, 0, 3'500'000);
  EXPECT_NEAR(watch.pass(kPush, 900'000'000, 900'000'000).force_n.x, 1.5 + 1.5 / 51, 1e-9);
}

TEST(OutputWatch, LetsGoWhenItIsTold) {
  Watched motors;
  motors.pass({}, 0);
  motors.pass(kPush, 0);
  motors.watch.latch();
  motors.watch.latch();
  EXPECT_EQ(motors.watch.falls(), 1);
  EXPECT_EQ(motors.pass(kPush, 0).force_n.x, 0);
}

// It has a limit of its own, whatever the loop asks for.
TEST(OutputWatch, NoOneAsksForMoreThanItsCeiling) {
  for (const double stale_s : {10.0, 1e300, 0 / 0.0}) {
    Watched motors(stale_s);
    motors.pass({}, 0);
    EXPECT_EQ(motors.pass(kPush, 20'000).force_n.x, 3);
    EXPECT_EQ(motors.pass(kPush, 50'100).force_n.x, 0);
    EXPECT_TRUE(motors.watch.latched());
  }
}

// Times that a wild write left behind.
TEST(OutputWatch, ATimeThatCannotBeIsTooOld) {
  constexpr std::int64_t kNow = 1'000'000'000;
  for (const std::int64_t written_ns :
       {kNow + 1000, std::numeric_limits<std::int64_t>::max(),
        std::numeric_limits<std::int64_t>::min(), std::int64_t{0}}) {
    devices::OutputWatch watch;
    watch.pass({}, kNow, kNow);
    EXPECT_EQ(watch.pass(kPush, kNow, kNow).force_n.x, 3);
    EXPECT_EQ(watch.pass(kPush, written_ns, kNow).force_n.x, 0) << written_ns;
    EXPECT_TRUE(watch.latched());
  }
}

}  // namespace
}  // namespace forcelayer::test

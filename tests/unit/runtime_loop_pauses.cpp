// A loop that stands still for less than the stale limit, and the watch of the device's side, on a
// clock of the test's own: what is on the motors never jumps, and what falls is counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <random>

#include "runtime/devices/output_watch.h"
#include "runtime/loop/input_source.h"
#include "runtime/loop/output_stage.h"

namespace forcelayer::test {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr double kTick = 0.001, kMaxForceN = 10, kMaxTorqueNm = 0.5;

loop::OutputLimits limits_of(double stale_s) {
  loop::OutputLimits limits;
  limits.max_force_n = kMaxForceN;
  limits.max_torque_nm = kMaxTorqueNm;
  limits.stale_s = stale_s;
  return limits;
}

// The device's side: a watch, and readings that say what it did.
class WatchedDevice final : public devices::Device {
 public:
  explicit WatchedDevice(double stale_s) : watch_(stale_s) { capabilities_.hardware = true; }
  const DeviceCapabilities& capabilities() const override { return capabilities_; }
  Status start() override { return {}; }
  DeviceSample read(double) noexcept override {
    DeviceSample sample;
    sample.fresh = sample.present = true;
    sample.output_held = watch_.latched();
    sample.output_falls = watch_.falls();
    return sample;
  }
  void write(const Wrench& wrench) noexcept override {
    newest_ = wrench;
    written_ns_ = now_ns;
  }
  void stop() noexcept override {}

  Wrench motors() { return watch_.pass(newest_, written_ns_, now_ns); }
  const devices::OutputWatch& watch() const { return watch_; }

  std::int64_t now_ns = 1'000'000'000;

 private:
  DeviceCapabilities capabilities_;
  devices::OutputWatch watch_;
  Wrench newest_;
  std::int64_t written_ns_ = now_ns;
};

// A hand that presses with more than the limits, through the stage and the watch.
class Press {
 public:
  explicit Press(double stale_s)
      : stale_s_(stale_s), device_(stale_s), stage_(limits_of(stale_s)) {}

  // The device's side goes on for so many ms, the loop does not. The loop's next tick follows.
  void pause(int ms, const Wrench& wanted) {
    for (int i = 0; i < ms; ++i) let_pass();
    tick(wanted);
  }
  void run(int ms, const Wrench& wanted) {
    for (int i = 0; i < ms; ++i) tick(wanted);
  }

  const loop::OutputStage& stage() const { return stage_; }
  double force_n() const { return glm::length(motors_.force_n); }
  double falls() const { return falls_; }  // by the watch, of the force, 1 from the limit to zero
  double seconds() const { return static_cast<double>(device_.now_ns) * 1e-9 - 1; }

 private:
  void tick(const Wrench& wanted) {
    device_.now_ns += kMs / 2;
    StepInput input;
    input_.next(0, kTick, input);
    loop::OutputFrame frame;
    frame.health = input_.health();
    const double since_s = static_cast<double>(device_.now_ns - ticked_ns_) * 1e-9;
    frame.health.loop_late = ticked_ns_ != 0 && since_s - kTick > stale_s_;  // as loop.cpp has it
    ticked_ns_ = device_.now_ns;
    frame.free_of_contact = true;
    frame.wanted = wanted;
    device_.write(stage_.pass(frame, kTick));
    device_.now_ns -= kMs / 2;
    let_pass();
  }

  // A period of the device. What its side does not take away moves by the slew limit at most.
  void let_pass() {
    device_.now_ns += kMs;
    const Wrench before = motors_;
    const double fallen = device_.watch().falls();
    motors_ = device_.motors();
    const double fall = device_.watch().falls() - fallen;
    const double force = glm::length(motors_.force_n), torque = glm::length(motors_.torque_nm);
    if (fall > 0) falls_ += std::max(0.0, glm::length(before.force_n) - force) / kMaxForceN;
    constexpr double kNoFade = 1 + 1e-5;  // of the watch's last step
    EXPECT_LE(force - glm::length(before.force_n), 2 * kNoFade) << seconds();
    EXPECT_LE(torque - glm::length(before.torque_nm), 0.1 * kNoFade) << seconds();
    if (fall == 0 && force > 0) {
      EXPECT_LE(glm::length(motors_.force_n - before.force_n), 2 * kNoFade) << seconds();
      EXPECT_LE(glm::length(motors_.torque_nm - before.torque_nm), 0.1 * kNoFade) << seconds();
    }
    const double age_s = static_cast<double>(device_.now_ns - ticked_ns_) * 1e-9;
    EXPECT_LE(force, kMaxForceN * devices::late_gain(age_s / stale_s_) + 1e-9);
  }

  double stale_s_;
  WatchedDevice device_;
  loop::DeviceInput input_{device_, {}};
  loop::OutputStage stage_;
  Wrench motors_;
  std::int64_t ticked_ns_ = 0;
  double falls_ = 0;
};

const Wrench kDown{{0, -24, -32}, {2, 0, 0}}, kUp{{0, 24, 32}, {-2, 0, 0}};
constexpr double kStaleS[] = {0.005, 0.02, 0.05};

TEST(LoopPauses, TheForceComesBackByARamp) {
  for (const double stale_s : kStaleS) {
    for (int pause_ms = 1; pause_ms * 0.001 < 1.5 * stale_s; ++pause_ms) {
      SCOPED_TRACE(testing::Message() << "stale limit " << stale_s << " pause " << pause_ms);
      Press press(stale_s);
      press.run(400, kDown);
      ASSERT_NEAR(press.force_n(), kMaxForceN, 1e-9);
      press.pause(pause_ms, kDown);
      press.run(300, kDown);
      if (press.stage().trips() > 0) {
        EXPECT_GT(pause_ms * 0.001, stale_s - 0.0015);
        EXPECT_EQ(press.force_n(), 0);
      } else {
        EXPECT_GT(press.force_n(), 0.99 * kMaxForceN);
      }
    }
  }
}

// While the loop's own force turns round as fast as it may.
TEST(LoopPauses, TheRampAndTheSlewTogetherStayWithinTheSlewLimit) {
  for (const double stale_s : kStaleS) {
    for (int half_ms = 1; half_ms < 20; ++half_ms) {
      Press press(stale_s);
      press.run(400, kDown);
      press.pause(static_cast<int>(900 * stale_s), kDown);
      for (int i = 0; i < 20; ++i) press.run(half_ms, i % 2 == 0 ? kUp : kDown);
      if (testing::Test::HasFailure()) return;
    }
  }
}

// Pauses that repeat trip, or are far between: falls add up to what the bucket holds.
TEST(LoopPauses, NoSawtoothIsKeptAlive) {
  int tripped = 0;
  for (const double stale_s : kStaleS) {
    for (const double part : {0.45, 0.6, 0.8, 0.95}) {
      for (const int gap_ms : {5, 10, 30, 100, 300}) {
        SCOPED_TRACE(testing::Message() << stale_s << " " << part << " " << gap_ms);
        Press press(stale_s);
        press.run(400, kDown);
        const double begin_s = press.seconds();
        while (press.stage().trips() == 0 && press.seconds() < 60) {
          press.pause(static_cast<int>(part * stale_s * 1000), kDown);
          press.run(gap_ms, kDown);
        }
        const double passed_s = press.seconds() - begin_s;
        EXPECT_LE(press.falls(), loop::OutputGate::kEpisodes + passed_s + 1);
        if (press.stage().trips() > 0) {
          ++tripped;
          EXPECT_EQ(press.stage().last_trip(), TripCause::kLoopLate);
          EXPECT_GT(press.falls(), loop::OutputGate::kEpisodes - 1);
        }
        if (testing::Test::HasFailure()) return;
      }
    }
  }
  EXPECT_GT(tripped, 10);
}

TEST(LoopPauses, AtRandom) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const double stale_s = kStaleS[seed % 3];
    const int longest_ms = static_cast<int>(stale_s * 1200);
    Press press(stale_s);
    for (int i = 0; i < 100; ++i) {
      const Wrench& wanted = random() % 4 == 0 ? kUp : kDown;
      press.run(1 + static_cast<int>(random() % 300), wanted);
      press.pause(static_cast<int>(random() % static_cast<unsigned>(longest_ms)), wanted);
      if (press.stage().trips() > 0) break;
    }
    EXPECT_LE(press.falls(), loop::OutputGate::kEpisodes + press.seconds() + 1);
    if (testing::Test::HasFailure()) return;
  }
}

}  // namespace
}  // namespace forcelayer::test

// The gate over time: every state with every input, and every chain of three faults.
#include "runtime/loop/output_gate.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <deque>
#include <glm/geometric.hpp>
#include <set>
#include <tuple>

#include "runtime/coupling/coupling.h"
#include "runtime/loop/input_source.h"
#include "runtime/loop/output_stage.h"

namespace forcelayer::test {
namespace {

using loop::GateInput;
using loop::GateState;
using loop::OutputGate;

// Inputs of a frame, as the table in output_gate.h names them.
enum class Kind { kSound, kReady, kLate, kFaded, kBad, kPassing, kLasting, kClutch, kSwap };
constexpr Kind kKinds[] = {Kind::kSound,   Kind::kReady,   Kind::kLate,   Kind::kFaded, Kind::kBad,
                           Kind::kPassing, Kind::kLasting, Kind::kClutch, Kind::kSwap};
constexpr double kLateGain = 0.375;
constexpr double kDeviceFall = 0.5;

GateInput input_of(Kind kind) {
  GateInput in;
  in.ready = kind != Kind::kSound;
  if (kind == Kind::kLate) in.late_gain = kLateGain;
  if (kind == Kind::kFaded) in.device_fall = kDeviceFall;
  if (kind == Kind::kBad) in.fault = TripCause::kImplausible;
  if (kind == Kind::kPassing) in.cause = TripCause::kLoopLate;
  if (kind == Kind::kLasting) in.cause = TripCause::kDeviceLost;
  in.lasting = kind == Kind::kLasting;
  in.clutch = kind == Kind::kClutch;
  in.swapping = kind == Kind::kSwap;
  return in;
}

// Coarse times, so that the states are few: a ramp of 4 frames, a fade of 2, a zero of 3, a bucket
// of 5 bad frames that forgets one in 10 frames.
constexpr double kDt = 0.1;
loop::GateLimits coarse(bool rearm_alone) {
  loop::GateLimits limits;
  limits.zero_s = 0.3;
  limits.ramp_s = 0.4;
  limits.fade_s = 0.2;
  limits.stale_s = 0.5;
  limits.rearm_alone = rearm_alone;
  return limits;
}

// A state as far as it decides what follows: the bucket in 400ths, the gain in eighths, the
// frames since the last fault, whether the last frame was bad.
struct Walker {
  OutputGate gate;
  int held = 0;
  bool was_bad = false;

  auto key() const {
    return std::tuple(gate.state(), std::lround(gate.gain() * 8), std::lround(gate.level() * 400),
                      std::min(held, 4), was_bad);
  }
};

// The bucket, from its definition. Whether it overflows.
bool reference_bucket(double& level, double gain, Kind kind, bool was_bad) {
  if (kind == Kind::kBad) {
    level += was_bad ? kDt / 0.5 : std::max(kDt / 0.5, 0.2);
  } else {
    level = std::max(0.0, level - 0.2 * kDt);
    if (kind == Kind::kLate) level += 0.2 * std::max(0.0, gain - kLateGain);
    if (kind == Kind::kFaded) level += 0.2 * gain * kDeviceFall;
  }
  const bool over = level > 1 + 1e-9;
  level = std::min(level, 1.0);
  return over;
}

// The table of output_gate.h, row by row.
GateState reference_state(GateState state, Kind kind, bool over, bool rearm_alone, double gain,
                          bool held_long) {
  const bool cause = kind == Kind::kPassing || kind == Kind::kLasting || over;
  const bool lasting = kind == Kind::kLasting || over;
  const bool bad = kind == Kind::kBad;
  switch (state) {
    case GateState::kWaiting:
      if (lasting) return GateState::kTripped;
      return cause || bad || kind == Kind::kSound ? state : GateState::kHeld;
    case GateState::kTripped:
      if (cause || bad) return state;
      if (kind == Kind::kClutch) return GateState::kHeld;
      return rearm_alone && kind != Kind::kSound ? GateState::kHeld : state;
    default:
      break;
  }
  if (cause) return GateState::kTripped;
  if (bad || (kind == Kind::kLate && gain >= kLateGain)) return GateState::kHeld;
  if (state == GateState::kHeld && !held_long) return state;
  if (kind == Kind::kClutch || kind == Kind::kSwap) return GateState::kRamping;
  const double risen = std::min(kind == Kind::kLate ? kLateGain : 1, gain + kDt / 0.4);
  return risen < 1 ? GateState::kRamping : GateState::kFull;
}

// One edge of the walk: what must hold of it.
void check_edge(const Walker& from, const Walker& to, Kind kind, bool rearm_alone) {
  const OutputGate &a = from.gate, &b = to.gate;
  double level = a.level();
  const bool over = reference_bucket(level, a.gain(), kind, from.was_bad);
  EXPECT_NEAR(b.level(), level, 1e-9);
  const bool held_long = (from.held + 1 + 0.5) * kDt >= 0.3;
  ASSERT_EQ(b.state(), reference_state(a.state(), kind, over, rearm_alone, a.gain(), held_long));
  // No force after a bad reading or a trip but by a ramp.
  if (kind == Kind::kBad || !b.armed()) {
    EXPECT_EQ(b.gain(), 0);
  }
  EXPECT_LE(b.gain(), a.gain() + kDt / 0.4 + 1e-12);
  if (b.gain() > a.gain()) {
    EXPECT_NE(b.state(), GateState::kHeld);
  }
  if (kind == Kind::kLate) {
    EXPECT_LE(b.gain(), kLateGain);
  }
  EXPECT_GE(b.gain(), 0);
  EXPECT_LE(b.gain(), 1);
  // Each fall by a fault is paid for, and nothing is forgotten faster than promised. So what comes
  // and goes is bounded over every path, however long.
  const bool clutched = kind == Kind::kClutch || kind == Kind::kSwap;
  const double on_device = kind == Kind::kFaded ? a.gain() * kDeviceFall : 0;
  const double fall = clutched ? 0 : std::max(0.0, a.gain() - b.gain()) + on_device;
  const double drained = kDt / (OutputGate::kEpisodes * OutputGate::kForgetS);
  if (b.armed()) {
    EXPECT_GE(b.level(), std::max(0.0, a.level() - drained) + 0.2 * fall - 1e-9);
  }
  // A trip is counted once and named.
  EXPECT_EQ(b.trips() - a.trips(), b.state() == GateState::kTripped && a.state() != b.state());
}

TEST(OutputGate, EveryStateWithEveryInput) {
  for (const bool rearm_alone : {false, true}) {
    std::set<decltype(std::declval<Walker>().key())> seen;
    std::deque<Walker> open{{OutputGate(coarse(rearm_alone))}};
    seen.insert(open.front().key());
    std::set<GateState> states;
    while (!open.empty() && !HasFatalFailure()) {
      const Walker from = open.front();
      open.pop_front();
      states.insert(from.gate.state());
      for (const Kind kind : kKinds) {
        Walker to = from;
        to.gate.pass(input_of(kind), kDt);
        to.was_bad = kind == Kind::kBad;
        const bool fault = to.was_bad || (kind == Kind::kLate && from.gate.gain() >= kLateGain);
        const bool armed_now = to.gate.armed() && !from.gate.armed();
        to.held = fault || armed_now ? 0 : from.held + 1;
        SCOPED_TRACE(testing::Message() << "state " << int(from.gate.state()) << " gain "
                                        << from.gate.gain() << " level " << from.gate.level()
                                        << " held " << from.held << " input " << int(kind));
        check_edge(from, to, kind, rearm_alone);
        if (HasFailure()) return;
        if (seen.insert(to.key()).second) open.push_back(to);
      }
    }
    EXPECT_EQ(states.size(), 5u);
    EXPECT_GT(seen.size(), 500u);
    EXPECT_LT(seen.size(), 50000u);
  }
}

// Whatever the rate of the loop.
TEST(OutputGate, FallsAddUpToWhatTheBucketHolds) {
  for (const double dt_s : {0.00025, 0.001, 0.004}) {
    for (const double every_s : {0.002, 0.03, 0.1, 0.3, 0.7}) {
      OutputGate gate((loop::GateLimits()));
      double falls = 0, sound_s = 0;
      const long period = std::lround(std::max(every_s, 2 * dt_s) / dt_s);
      for (long i = 0; gate.trips() == 0 && double(i) * dt_s < 60; ++i) {
        const double before = gate.gain();
        gate.pass(input_of(i > 1000 && i % period == 0 ? Kind::kBad : Kind::kReady), dt_s);
        falls += std::max(0.0, before - gate.gain());
        sound_s += dt_s;
      }
      EXPECT_EQ(gate.trips(), 1u) << dt_s << " " << every_s;
      EXPECT_LE(falls, OutputGate::kEpisodes + sound_s / OutputGate::kForgetS + 1);
    }
  }
}

TEST(OutputGate, ABadReadingNowAndThenIsForgotten) {
  OutputGate gate((loop::GateLimits()));
  for (int i = 0; i < 60'000; ++i) {
    gate.pass(input_of(i % 1100 == 1099 ? Kind::kBad : Kind::kReady), 0.001);
  }
  EXPECT_EQ(gate.trips(), 0u);
}

// A device that gives a reading every 4 ms and says nothing of its rate: fainter, without a buzz.
TEST(OutputGate, ALatenessThatRepeatsKeepsTheGainDown) {
  OutputGate gate((loop::GateLimits()));
  for (int i = 0; i < 400; ++i) gate.pass(input_of(Kind::kReady), 0.001);
  ASSERT_EQ(gate.gain(), 1);
  for (int i = 0; i < 5000; ++i) {
    gate.pass(input_of(i % 4 == 0 ? Kind::kLate : Kind::kReady), 0.001);
    EXPECT_EQ(gate.gain(), kLateGain);
  }
  EXPECT_EQ(gate.trips(), 0u);
}

// ---- Chains of readings, through the device's input and the stage.

constexpr double kTick = 0.001;
enum class Reading { kGood, kLate, kMissing, kNonFinite, kFar, kJumping, kFrozen, kClaimed };
constexpr int kReadings = 8;
constexpr int kRuns[] = {1, 3, 6, 50, 250};

class ChainDevice final : public devices::Device {
 public:
  ChainDevice() {
    capabilities_.name = "chain";
    capabilities_.workspace_radius_m = 0.3;
    capabilities_.rate_hz = 1000;
    capabilities_.senses_velocity = true;
    capabilities_.hardware = true;
    sample.present = true;
  }
  const DeviceCapabilities& capabilities() const override { return capabilities_; }
  Status start() override { return {}; }
  DeviceSample read(double) noexcept override { return sample; }
  void write(const Wrench&) noexcept override {}
  void stop() noexcept override {}

  void set(Reading reading, int tick) {
    sample = {};
    sample.present = reading != Reading::kMissing;
    sample.fresh = reading != Reading::kFrozen && (reading != Reading::kLate || tick % 5 == 0);
    glm::dvec3& p = sample.device_from_handle.position_m;
    if (reading == Reading::kNonFinite) p.x = std::nan("");
    if (reading == Reading::kFar) p.x = 130;
    if (reading == Reading::kJumping) p.y = tick % 2 == 0 ? 0.2 : -0.2;
    if (reading == Reading::kClaimed) sample.velocity.angular_radps.z = 1000;
  }

  DeviceSample sample;

 private:
  DeviceCapabilities capabilities_;
};
ChainDevice device;  // of every chain: each tick sets all that it says

loop::OutputLimits chain_limits() {
  loop::OutputLimits limits;
  limits.max_force_n = 10;
  limits.max_torque_nm = 0.5;
  return limits;
}

// Holds the handle in a contact that wants 40 N and 2 N m, and watches what goes out.
class Chain {
 public:
  void run(Reading reading, int ticks) {
    for (int i = 0; i < ticks; ++i) tick(reading);
  }

  void tick(Reading reading, bool clutch = false) {
    device.set(reading, ticks_++);
    StepInput input;
    input_.next(0, kTick, input);
    loop::OutputFrame frame;
    frame.health = input_.health();
    frame.health.clutch = clutch;
    frame.faulty = input.valid != kInputValid;
    frame.turn_radps = glm::length(input.handle_velocity.angular_radps);
    frame.wanted = {{0, 24, 32}, {2, 0, 0}};
    frame.free_of_contact = ticks_ < 10;
    const Wrench out = stage_.pass(frame, kTick);
    check(frame, out);
    last_ = out;
  }

  const loop::OutputStage& stage() const { return stage_; }
  double force_n() const { return glm::length(last_.force_n); }
  int rises() const { return rises_; }
  int bad_row() const { return longest_row_; }

 private:
  void check(const loop::OutputFrame& frame, const Wrench& out) {
    const double force = glm::length(out.force_n), torque = glm::length(out.torque_nm);
    ASSERT_LE(force, 10 * (1 + 1e-12));
    ASSERT_LE(torque, 0.5 * (1 + 1e-12));
    if (force > 0) {
      ASSERT_LE(glm::length(out.force_n - last_.force_n), 2 * (1 + 1e-9));
      ASSERT_LE(glm::length(out.torque_nm - last_.torque_nm), 0.1 * (1 + 1e-9));
    }
    row_ = frame.faulty ? row_ + 1 : 0;
    longest_row_ = std::max(longest_row_, row_);
    since_bad_ = frame.faulty || stage_.state() != OutputState::kArmed ? 0 : since_bad_ + 1;
    ASSERT_LE(force, 10.0 * since_bad_ / 200 + 1e-9);
    ASSERT_LE(torque, 0.5 * since_bad_ / 200 + 1e-9);
    rises_ += last_.force_n == glm::dvec3(0) && force > 0 ? 1 : 0;
    // Tripped: nothing but the clutch arms it.
    if (stage_.trips() > 0 && !frame.health.clutch && !clutched_) {
      ASSERT_EQ(force, 0);
    }
    clutched_ |= frame.health.clutch;
  }

  loop::DeviceInput input_{device, {}};
  loop::OutputStage stage_{chain_limits()};
  Wrench last_;
  int ticks_ = 0, since_bad_ = 0, rises_ = 0, row_ = 0, longest_row_ = 0;
  bool clutched_ = false;
};

// Armed, at full force.
Chain pressing() {
  Chain chain;
  chain.run(Reading::kGood, 300);
  EXPECT_NEAR(chain.force_n(), 10, 1e-9);
  return chain;
}

// Sound again: what did not trip comes back by itself, the rest by the clutch.
void check_return(Chain chain) {
  chain.run(Reading::kGood, 300);
  if (chain.stage().trips() > 0) {
    EXPECT_EQ(chain.force_n(), 0);
    chain.tick(Reading::kGood, true);
    chain.run(Reading::kGood, 300);
  }
  EXPECT_NEAR(chain.force_n(), 10, 1e-9);
}

// Counts of the walk over all chains.
struct ChainCount {
  int chains = 0, tripped = 0;
};

// Every chain that goes on from `chain` by `left` readings. A run of 250 passes those of 1, 3, 6
// and 50 on its way, and chains that begin alike are one until they part. `length`: of all runs so
// far where they are alike, 0 before the first, -1 where they are not.
void walk_chains(const Chain& chain, int left, int length, ChainCount& count) {
  if (left == 0) {
    ++count.chains;
    count.tripped += chain.stage().trips() > 0 ? 1 : 0;
    if (chain.bad_row() > 5) {
      EXPECT_GE(chain.stage().trips(), 1u);
    }
    EXPECT_LE(chain.rises(), 1 + 5 + 1);
    if (length > 0) check_return(chain);
    return;
  }
  for (int kind = 0; kind < kReadings; ++kind) {
    Chain longer = chain;
    int ticks = 0;
    for (const int run : kRuns) {
      SCOPED_TRACE(testing::Message() << left << " left: reading " << kind << " for " << run);
      longer.run(static_cast<Reading>(kind), run - ticks);
      ticks = run;
      walk_chains(longer, left - 1, length == 0 || length == run ? run : -1, count);
      if (testing::Test::HasFailure()) return;
    }
  }
}

TEST(OutputGate, EveryChainOfThreeReadings) {
  ChainCount count;
  walk_chains(pressing(), 3, 0, count);
  EXPECT_EQ(count.chains, 64'000);
  EXPECT_GT(count.tripped, count.chains / 2);
  EXPECT_LT(count.tripped, count.chains);
}

// The same readings, one in so many, for a minute: they trip before long, or are far between.
TEST(OutputGate, NoOscillationIsKeptAlive) {
  for (int kind = 1; kind < kReadings; ++kind) {
    for (const int one_in : {2, 3, 6, 10, 50, 200, 500, 900}) {
      for (const int bad : {1, 3}) {
        if (bad >= one_in) continue;
        SCOPED_TRACE(testing::Message() << "reading " << kind << " " << bad << " in " << one_in);
        Chain chain = pressing();
        const int before = chain.rises();
        int ticks = 0;
        for (; chain.stage().trips() == 0 && ticks < 60'000; ++ticks) {
          chain.tick(ticks % one_in < bad ? static_cast<Reading>(kind) : Reading::kGood);
          if (HasFailure()) return;
        }
        EXPECT_LE(chain.rises() - before, 5 + ticks / 1000 + 1);
      }
    }
  }
}

}  // namespace
}  // namespace forcelayer::test

// Judges each frame of a loop by what was injected and by what goes to the motors.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <glm/geometric.hpp>

#include "runtime/loop/input_source.h"
#include "runtime/loop/output_stage.h"
#include "runtime/machine/real_time.h"
#include "tests/fuzz/clock/truth.h"
#include "tests/fuzz/interior_point.h"

namespace forcelayer::test {

template <typename T>
T load(const T& word) {
  return __atomic_load_n(&word, __ATOMIC_ACQUIRE);
}
template <typename T>
void store(T& word, T value) {
  __atomic_store_n(&word, value, __ATOMIC_RELEASE);
}

// An input that stands between the loop and the device's. Never blocks.
class FrameJudge final : public loop::InputSource {
 public:
  // Scene and part of its own, which no fault of the files reaches.
  FrameJudge(loop::InputSource& inner, truth& shared, const loop::OutputLimits& limits,
             const Voxmap& map, const PshellView& shell)
      : inner_(inner), truth_(shared), limits_(limits), map_(map), shell_(shell) {}

  bool next(double time_s, double dt_s, StepInput& input) noexcept override {
    const std::uint64_t readings = load(truth_.readings);
    const std::int64_t bad_since = load(truth_.bad_since);
    const bool more = inner_.next(time_s, dt_s, input);
    const bool silent = readings == load(truth_.readings) && readings == readings_;
    silent_ticks_ = silent ? silent_ticks_ + 1 : 0;
    readings_ = readings;
    must_refuse_ =
        (bad_since != 0 && bad_since == load(truth_.bad_since)) || silent_ticks_ > kStaleTicks + 1;
    if (must_refuse_ && inner_.health().trouble == InputTrouble::kNone) {
      breaks("a bad reading that is taken for a good one");
    }
    return more;
  }

  InputHealth health() const noexcept override { return inner_.health(); }
  const DevicePlacement& placement() const override { return inner_.placement(); }

  void output(const Frame& frame) noexcept override {
    judge(frame);
    write(frame.device_wrench, [&] { inner_.output(frame); });
  }
  void silence() noexcept override {
    write({}, [&] { inner_.silence(); });
  }

  struct Counts {
    std::uint64_t frames = 0, refused = 0, late = 0, touching = 0, with_force = 0;
    int broken = 0;
  };
  const Counts& counts() const { return counts_; }
  std::uint64_t frames() const { return frames_.load(); }  // from any thread
  OutputState output_state() const { return state_.load(); }
  const char* what() const { return what_; }

 private:
  static constexpr std::uint64_t kStaleTicks = 5;
  static constexpr double kDt = 0.001;

  template <typename Write>
  void write(const Wrench& wrench, const Write& to_device) noexcept {
    const std::uint64_t n = truth_.writes;
    truth_write& entry = truth_.write[n % TRUTH_WRITES];
    store(entry.done_ns, std::int64_t{0});
    for (int axis = 0; axis < 3; ++axis) {
      entry.force_n[axis] = wrench.force_n[axis];
      entry.torque_nm[axis] = wrench.torque_nm[axis];
    }
    store(truth_.writes, n + 1);
    to_device();
    store(entry.done_ns, static_cast<std::int64_t>(machine::monotonic_ns()));
  }

  void judge(const Frame& frame) noexcept {
    const Wrench& w = frame.device_wrench;
    const double force_n = glm::length(w.force_n), torque_nm = glm::length(w.torque_nm);
    const bool zero = force_n == 0 && torque_nm == 0;
    if (!(force_n <= limits_.max_force_n * kRounding &&
          torque_nm <= limits_.max_torque_nm * kRounding)) {
      breaks("a wrench beyond its limits");
    }
    const double fraction = kDt / limits_.slew_s * kRounding;
    const bool force_slew =
        force_n > 0 && glm::length(w.force_n - last_.force_n) > limits_.max_force_n * fraction;
    const bool torque_slew = torque_nm > 0 && glm::length(w.torque_nm - last_.torque_nm) >
                                                  limits_.max_torque_nm * fraction;
    if (force_slew || torque_slew) breaks("a wrench beyond its slew");
    const bool detected = must_refuse_ || frame.health.trouble != InputTrouble::kNone ||
                          frame.health.loop_late || frame.output == OutputState::kTripped;
    if (detected && !zero) breaks("a force in the frame of a detection");
    since_detected_ = detected ? 0 : since_detected_ + 1;
    // The fraction of the wrench that may be back by now: nothing for zero_s, then a ramp.
    const double gain =
        (static_cast<double>(since_detected_) * kDt - limits_.zero_s) / limits_.ramp_s + 0.006;
    if (since_detected_ < 300 && (force_n > limits_.max_force_n * std::max(gain, 0.0) ||
                                  torque_nm > limits_.max_torque_nm * std::max(gain, 0.0))) {
      breaks("force after a detection, but not by a ramp");
    }
    if (counts_.frames % 61 == 0 && frame.input.valid == kInputValid &&
        frame.result.report.interior == 0 &&
        has_interior_point(map_, shell_, frame.result.report.world_from_center)) {
      breaks("a penetration without a report");
    }
    last_ = w;
    counts_.refused += frame.health.trouble != InputTrouble::kNone;
    counts_.late += frame.health.loop_late;
    counts_.touching += frame.result.report.surface > 0;
    counts_.with_force += !zero;
    ++counts_.frames;
    state_.store(frame.output);
    frames_.store(counts_.frames);
  }

  void breaks(const char* what) noexcept {
    if (counts_.broken++ > 0) return;
    std::snprintf(what_, sizeof what_, "frame %llu: %s",
                  static_cast<unsigned long long>(counts_.frames), what);
  }

  static constexpr double kRounding = 1 + 1e-9;

  loop::InputSource& inner_;
  truth& truth_;
  loop::OutputLimits limits_;
  const Voxmap& map_;
  const PshellView& shell_;
  std::uint64_t readings_ = 0, silent_ticks_ = 0, since_detected_ = 1000;
  bool must_refuse_ = false;
  Wrench last_;
  Counts counts_;
  std::atomic<std::uint64_t> frames_{0};
  std::atomic<OutputState> state_{OutputState::kWaiting};
  char what_[160] = "";
};

}  // namespace forcelayer::test

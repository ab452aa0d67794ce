// The watch of a device's I/O side over a late loop. It holds the last wrench, then fades it, then
// gives zero until the loop has shown that it starts from zero. What it faded, it ramps in again.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/vec3.hpp>

#include "forcelayer/pose.h"
#include "forcelayer/stale_limit.h"

namespace forcelayer::devices {

// Gain of an output that is `age_fraction` of its stale limit old: 1 up to kLateGrace (two periods
// of 1 kHz in 5 ms, so that one late frame is not felt), from there falling in a line to 0.
inline constexpr double kLateGrace = 0.4;
inline double late_gain(double age_fraction) noexcept {
  if (age_fraction <= kLateGrace) return 1;
  return age_fraction < 1 ? (1 - age_fraction) / (1 - kLateGrace) : 0;
}

class OutputWatch {
 public:
  // Time constant of the return to full gain: 98% in 0.2 s, the ramp of the loop's gate. Not below
  // OutputLimits::slew_s: then the return and the loop's own slew together stay within the slew
  // limit, since the gain that is missing falls no faster than the limit leaves room.
  static constexpr double kReturnS = 0.05;

  // `stale_s`: no more than kStaleCeilingS, whatever is asked for. `period_s`: of the device. The
  // gain rises by no more than is due in one period, however long ago the last pass was.
  explicit OutputWatch(double stale_s = kStaleLimitS, double period_s = 0.001)
      : stale_s_(stale_s < kStaleCeilingS ? stale_s : kStaleCeilingS), period_s_(period_s) {}

  // The wrench for the motors now. `newest` is the loop's last, written at `written_ns`. It fades
  // with age (late_gain) and comes back within kReturnS. Beyond the stale limit it is zero, and
  // stays so until the loop has written exactly zero. The loop does that while it is not armed and
  // for OutputLimits::zero_s after arming; then it ramps.
  Wrench pass(const Wrench& newest, std::int64_t written_ns, std::int64_t now_ns) noexcept {
    const double age_s = seconds_between(written_ns, now_ns);
    const double since_s = std::clamp(seconds_between(last_ns_, now_ns), 0.0, period_s_);
    last_ns_ = now_ns;
    const bool in_time = age_s >= 0 && age_s <= stale_s_;  // not for a time to come
    const bool zero = newest.force_n == glm::dvec3(0) && newest.torque_nm == glm::dvec3(0);
    if (!in_time) latch();
    if (latched_ && !(in_time && zero)) return {};
    latched_ = false;
    if (zero) {
      gain_ = 1;  // nothing is faded: the loop ramps from here
      return {};
    }
    const double allowed = late_gain(age_s / stale_s_);
    if (allowed < gain_) {
      fall_to(allowed);
    } else {
      gain_ += (1 - gain_) * since_s / (since_s + kReturnS);
      gain_ = std::min(gain_ > 1 - kNoFade ? 1 : gain_, allowed);
    }
    return {newest.force_n * gain_, newest.torque_nm * gain_};
  }

  // Zero until the loop has written zero.
  void latch() noexcept {
    if (!latched_) fall_to(0);
    latched_ = true;
  }

  bool latched() const { return latched_; }
  // Sum of the falls of the gain so far, which the loop cannot see (InputHealth::output_fall).
  double falls() const { return falls_; }

 private:
  static constexpr double kNoFade = 1e-6;

  // Any bytes may stand for a time: the difference of two int64 could overflow.
  static double seconds_between(std::int64_t from_ns, std::int64_t to_ns) {
    return (static_cast<double>(to_ns) - static_cast<double>(from_ns)) * 1e-9;
  }

  void fall_to(double gain) noexcept {
    falls_ += gain_ - gain;
    gain_ = gain;
  }

  double stale_s_, period_s_;
  bool latched_ = true;  // until the loop's first zero
  double gain_ = 1;
  double falls_ = 0;
  std::int64_t last_ns_ = 0;
};

}  // namespace forcelayer::devices

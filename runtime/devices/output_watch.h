// The watch of a device's I/O side over a late loop. It holds the last wrench, then fades it, then
// gives zero until the loop has shown that it starts from zero.
#pragma once

#include <glm/vec3.hpp>

#include "forcelayer/pose.h"
#include "forcelayer/stale_limit.h"

namespace forcelayer::devices {

// Gain of an output that is `age_share` of its stale limit old: 1 up to kLateGrace (two periods of
// 1 kHz in 5 ms, so that one late frame is not felt), from there falling in a line to 0.
inline constexpr double kLateGrace = 0.4;
inline double late_gain(double age_share) noexcept {
  if (age_share <= kLateGrace) return 1;
  return age_share < 1 ? (1 - age_share) / (1 - kLateGrace) : 0;
}

class OutputWatch {
 public:
  // No more than kStaleCeilingS, whatever is asked for.
  explicit OutputWatch(double stale_s = kStaleLimitS)
      : stale_s_(stale_s < kStaleCeilingS ? stale_s : kStaleCeilingS) {}

  // The wrench for the motors now. `newest` is the loop's last, written `age_s` ago. It fades with
  // age (late_gain). Beyond the stale limit it is zero, and stays so until the loop has written
  // exactly zero. The loop does that while it is not armed and for OutputLimits::zero_s after
  // arming; then it ramps.
  Wrench pass(const Wrench& newest, double age_s) noexcept {
    const bool in_time = age_s >= 0 && age_s <= stale_s_;  // not for NaN, nor for a time to come
    if (!in_time) latched_ = true;
    const bool zero = newest.force_n == glm::dvec3(0) && newest.torque_nm == glm::dvec3(0);
    if (latched_ && in_time && zero) latched_ = false;
    if (latched_) return {};
    const double gain = late_gain(age_s / stale_s_);
    return {newest.force_n * gain, newest.torque_nm * gain};
  }

  bool latched() const { return latched_; }

 private:
  double stale_s_;
  bool latched_ = true;  // until the loop's first zero
};

}  // namespace forcelayer::devices

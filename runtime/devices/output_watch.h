// What the I/O side of a device makes of a loop that is late: the last wrench held, then faded,
// then zero until the loop has shown that it starts from zero (DESIGN 7, "Failing").
#pragma once

#include <glm/vec3.hpp>

#include "forcelayer/pose.h"
#include "forcelayer/stale_limit.h"

namespace forcelayer {

// Share of the output that something `age_share` of its stale limit old deserves: all of it up to
// kLateGrace (two periods of 1 kHz in 5 ms: a late frame is a blip), from there in a line to none.
inline constexpr double kLateGrace = 0.4;
inline double late_gain(double age_share) noexcept {
  if (age_share <= kLateGrace) return 1;
  return age_share < 1 ? (1 - age_share) / (1 - kLateGrace) : 0;
}

class OutputWatch {
 public:
  explicit OutputWatch(double stale_s = kStaleLimitS) : stale_s_(stale_s) {}

  // The wrench for the motors now: `newest` is the loop's last, written `age_s` ago. Less with age
  // (late_gain), zero beyond the stale limit, and from then on zero until the loop has written
  // exactly zero: it does so in every frame in which it is not armed, for zero_s longer
  // (OutputLimits), and ramps from there.
  Wrench pass(const Wrench& newest, double age_s) noexcept {
    if (!(age_s <= stale_s_)) latched_ = true;
    const bool zero = newest.force_n == glm::dvec3(0) && newest.torque_nm == glm::dvec3(0);
    if (latched_ && age_s <= stale_s_ && zero) latched_ = false;
    if (latched_) return {};
    const double gain = late_gain(age_s / stale_s_);
    return {newest.force_n * gain, newest.torque_nm * gain};
  }

  bool latched() const { return latched_; }

 private:
  double stale_s_;
  bool latched_ = true;  // until the loop's first zero
};

}  // namespace forcelayer

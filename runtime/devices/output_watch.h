// What the I/O side of a device makes of a loop that is late: the last wrench held, then faded,
// then zero until the loop has shown that it starts from zero (DESIGN 7, "Failing").
#pragma once

#include <glm/vec3.hpp>

#include "runtime/pose.h"

namespace forcelayer {

class OutputWatch {
 public:
  static constexpr double kStaleS = 0.005;    // the host's stale limit (DESIGN 7)
  static constexpr double kGraceShare = 0.4;  // of it: two periods at 1 kHz, a late frame is a blip

  explicit OutputWatch(double stale_s = kStaleS) : stale_s_(stale_s) {}

  // The wrench for the motors now: `newest` is the loop's last, written `age_s` ago. Full up
  // to kGraceShare of stale_s, from there falling in a line to zero at stale_s, and from then on
  // zero until the loop has written exactly zero: it does so in every frame in which it is not
  // armed, and ramps from there.
  Wrench pass(const Wrench& newest, double age_s) noexcept {
    if (!(age_s <= stale_s_)) latched_ = true;
    const bool zero = newest.force_n == glm::dvec3(0) && newest.torque_nm == glm::dvec3(0);
    if (latched_ && age_s <= stale_s_ && zero) latched_ = false;
    if (latched_) return {};
    const double grace_s = kGraceShare * stale_s_;
    const double gain = age_s <= grace_s ? 1 : (stale_s_ - age_s) / (stale_s_ - grace_s);
    return {newest.force_n * gain, newest.torque_nm * gain};
  }

  bool latched() const { return latched_; }

 private:
  double stale_s_;
  bool latched_ = true;  // until the loop's first zero
};

}  // namespace forcelayer

// The handle's velocity from its poses, for devices that do not sense it.
#pragma once

#include "runtime/pose.h"

namespace forcelayer {

// First-order low-pass of the backward difference: v += (dx/dt - v) dt / (dt + tau). Encoder steps
// of D then make at most D / tau of ripple instead of D / dt. A step that no hand makes (faster
// than the limits) is a jump, not a motion: it passes as zero velocity.
class HandleVelocity {
 public:
  static constexpr double kTimeConstantS = 0.005;
  static constexpr double kMaxSpeedMps = 10;    // of a hand: a fast throw
  static constexpr double kMaxTurnRadps = 100;  // the same for the wrist

  void reset() noexcept { known_ = false; }

  // The velocity after a sample `dt_s` later; zero at the first one.
  Twist update(const Pose& world_from_handle, double dt_s) noexcept;

 private:
  bool known_ = false;
  Pose last_;
  Twist velocity_;
};

}  // namespace forcelayer

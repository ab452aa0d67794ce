// The handle's velocity from its poses, for devices that do not sense it.
#pragma once

#include <array>

#include "forcelayer/pose.h"

namespace forcelayer {

// The median of the last three backward differences, component by component, through a first-order
// low-pass: v += (median - v) dt / (dt + tau).
//   - A jump in one tick, however far, is no motion: the median does not see it.
//   - Encoder steps of D make at most D / tau of ripple instead of D / dt.
//   - The estimate is never against the last motion: lagging behind a hand that turns back, it
//   would
//     make the coupling's damper push the hand on.
//   - What is faster than any hand passes as zero.
//   - A handle that stays where it is reaches exactly zero, so that what it holds can rest.
class HandleVelocity {
 public:
  static constexpr double kTimeConstantS = 0.005;
  static constexpr double kMaxSpeedMps = 10;       // of a hand: a fast throw
  static constexpr double kMaxTurnRadps = 100;     // the same for the wrist
  static constexpr double kLeastSpeedMps = 1e-6;   // of a handle that does not move: zero
  static constexpr double kLeastTurnRadps = 1e-5;  // the same

  void reset() noexcept { *this = {}; }

  // The velocity after a new reading `dt_s` after the last one, in the frame of the poses: the
  // device's own, in which hands are as fast as hands are. Zero at the first reading.
  Twist update(const Pose& device_from_handle, double dt_s) noexcept;

 private:
  bool known_ = false;
  Pose last_;
  std::array<Twist, 3> differences_{};  // newest first
  Twist velocity_;
};

}  // namespace forcelayer

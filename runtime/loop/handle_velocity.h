// The handle's velocity from its poses, for devices that do not sense it.
#pragma once

#include <array>

#include "forcelayer/pose.h"

namespace forcelayer::loop {

// The median of the last three backward differences, component by component, through a first-order
// low-pass: v += (median - v) dt / (dt + tau).
//   - A jump in one tick is no motion: the median drops it.
//   - Encoder steps of D make a ripple of at most D / tau instead of D / dt.
//   - The estimate never points against the last motion. An estimate that lags behind a hand that
//     turns back would make the coupling's damper push the hand on.
//   - A velocity beyond any hand's counts as zero.
//   - A still handle reaches exactly zero, so that the part can rest.
class HandleVelocity {
 public:
  static constexpr double kTimeConstantS = 0.005;
  static constexpr double kMaxSpeedMps = 10;     // of a hand: a fast throw
  static constexpr double kMaxTurnRadps = 100;   // the same for the wrist
  static constexpr double kMinSpeedMps = 1e-6;   // of a handle that does not move: zero
  static constexpr double kMinTurnRadps = 1e-5;  // the same

  void reset() noexcept { *this = {}; }

  // The velocity after a reading `dt_s` later than the last one, in the frame of the poses. That
  // must be the device's own frame, in which the limits of a hand's speed hold. Zero at the first
  // reading.
  Twist update(const Pose& device_from_handle, double dt_s) noexcept;

 private:
  bool known_ = false;
  Pose last_;
  std::array<Twist, 3> differences_{};  // newest first
  Twist velocity_;
};

}  // namespace forcelayer::loop

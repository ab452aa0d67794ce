// Whether the part goes where a scripted hand (--motion, --pull) leads it.
#pragma once

#include "forcelayer/frame.h"
#include "runtime/devices/motion_script.h"
#include "runtime/loop/loop_statistics.h"

namespace forcelayer::voxrun {

// The most that something held the part off the script.
struct Followed {
  double off_m = 0, off_rad = 0;  // of the part's center; about it, in the same frame
  double time_s = 0;
  loop::TouchedInFrame touched{};  // what the part pushed against there
  bool is_followed() const { return off_m == 0 && off_rad == 0; }
};

// Watches frames in order. A part is held off in a frame in which the hand feels a force, and in
// which it pulls the part by more than kNoPull: a hand that feels the device lags behind its script
// even in free space, and that is not held. Frames in which the part is held for the clutch or a
// change of the scene are left out.
class MotionWatch {
 public:
  static constexpr double kNoPullM = 0.0005;  // at the device, as kNoPullRad
  static constexpr double kNoPullRad = 0.005;
  static constexpr double kNoForceN = 0.01;

  MotionWatch(devices::MotionScript script, double motion_scale)
      : script_(std::move(script)), motion_scale_(motion_scale) {}

  void see(const Frame& frame) noexcept;
  const Followed& followed() const { return followed_; }

 private:
  devices::MotionScript script_;
  double motion_scale_;
  Followed followed_;
};

}  // namespace forcelayer::voxrun

// What stands between the step's wrench and the motors: arming, ramps, limits, and the way to fail
// A pure state machine: the same inputs give the same outputs.
#pragma once

#include <cstdint>

#include "forcelayer/frame.h"
#include "forcelayer/stale_limit.h"

namespace forcelayer {

struct OutputLimits {
  double max_force_n = 0;
  double max_torque_nm = 0;
  double zero_s = 0.02;   // zero for so long once armed: the device's side holds its own zero until
                          // it has seen the loop's, and a write of its has been seen to take 14 ms
  double ramp_s = 0.2;    // from zero to full output after arming and after the clutch
  double fade_s = 0.05;   // from full output to zero when the clutch is pressed
  double slew_s = 0.005;  // full output cannot rise from zero in less
  double max_speed_mps = 5;       // of the handle at the device: beyond it the output trips
  double stale_s = kStaleLimitS;  // input may be invalid for so long before the output trips
  bool rearm_alone = false;       // arm again without the user once a trip's cause is gone: for
                                  // simulated hands, never with a motor
};

// What the stage must know of a frame.
struct OutputFrame {
  Wrench wanted;         // about the handle's origin, device axes
  double speed_mps = 0;  // of the handle at the device
  InputHealth health;
  bool faulty = false;      // the step reported a fault: bad input, or none
  bool not_finite = false;  // of such faults: the input's numbers, or the motion overflowed
  bool map_lost = false;
  bool free_of_contact = false;
  bool unstretched = false;  // the part is registered where the coupling holds it
};

class OutputStage {
 public:
  explicit OutputStage(const OutputLimits& limits) : limits_(limits) {}

  // The wrench for the device, once a frame of `dt_s`.
  // - Armed where the frame is sound and the part free of contact or unstretched; that frame and
  //   those of zero_s still give exactly zero (OutputWatch), the next ones ramp in. A trip gives at
  //   least as much zero: its own frames, and those of arming again.
  // - A fault gives zero in the same frame. Where it lasts longer than stale_s, and at once where
  //   the device is gone, the loop late, the map lost, the wrench not finite or the hand too fast,
  //   the output trips: zero until armed again, by itself where the limits say so, else by the
  //   clutch, which the user presses and releases.
  // - What is the matter with the device, its numbers or the map trips an output that still waits,
  //   too: it may wait for a hand, not for a device that is gone.
  // - The clutch fades to zero and ramps back in when it is released; pressed, it arms. A swap
  //   fades and ramps in the same way, and arms nothing: that is for the user.
  Wrench pass(const OutputFrame& frame, double dt_s) noexcept;

  OutputState state() const { return state_; }
  bool at_zero() const { return gain_ == 0; }  // whatever the wrench
  TripCause last_trip() const { return last_trip_; }
  std::uint64_t trips() const { return trips_; }

 private:
  TripCause cause_to_trip(const OutputFrame& frame) const noexcept;
  bool trips_on(TripCause cause) const noexcept;
  void trip(TripCause cause) noexcept;
  bool may_arm(const OutputFrame& frame) const noexcept;
  Wrench limited(const Wrench& wanted, double gain) const noexcept;
  Wrench slewed(const Wrench& wanted, double dt_s) const noexcept;

  OutputLimits limits_;
  OutputState state_ = OutputState::kWaiting;
  TripCause last_trip_ = TripCause::kNone;
  std::uint64_t trips_ = 0;
  double gain_ = 0;  // of the ramp
  double armed_s_ = 0;
  double faulty_s_ = 0;
  Wrench last_;
};

}  // namespace forcelayer

// The output stage stands between the step's wrench and the motors. It arms, ramps, limits, and
// goes to zero on a fault. A pure state machine: the same inputs give the same outputs.
#pragma once

#include <cstdint>

#include "forcelayer/frame.h"
#include "forcelayer/stale_limit.h"

namespace forcelayer::loop {

struct OutputLimits {
  double max_force_n = 0;
  double max_torque_nm = 0;
  double zero_s = 0.02;   // exactly zero for so long after arming: OutputWatch lets go of its own
                          // zero only once it has seen the loop's, and a write can take 14 ms
  double ramp_s = 0.2;    // from zero to full output after arming and after the clutch
  double fade_s = 0.05;   // from full output to zero when the clutch is pressed
  double slew_s = 0.005;  // shortest rise from zero to the limits
  double max_speed_mps = 5;       // of the handle at the device: a faster hand trips the output
  double stale_s = kStaleLimitS;  // longest run of invalid inputs without a trip
  bool rearm_alone = false;       // arms again by itself once a trip's cause is gone: for simulated
                                  // hands, never with a motor
};

// The facts of a frame on which the stage decides.
struct OutputFrame {
  Wrench wanted;         // about the handle's origin, device axes
  double speed_mps = 0;  // of the handle at the device
  InputHealth health;
  bool faulty = false;      // the step reported a fault: bad input, or none
  bool not_finite = false;  // that fault: the input has such numbers, or the motion overflowed
  bool map_lost = false;
  bool free_of_contact = false;
  bool unstretched = false;  // the part is registered where the coupling holds it
};

class OutputStage {
 public:
  explicit OutputStage(const OutputLimits& limits) : limits_(limits) {}

  // The wrench for the device, once a frame of `dt_s`.
  // - Arming. A sound frame arms a waiting output if the part is free of contact or unstretched.
  //   The frame that arms and those of zero_s give exactly zero, as OutputWatch demands; then the
  //   output ramps in.
  // - Faults. A faulty frame gives zero. The output trips when faults last longer than stale_s. It
  //   trips at once when the device is gone, the loop late, the map lost, the wrench not finite or
  //   the hand too fast.
  // - Trips. A tripped output stays at zero until the user presses and releases the clutch. With
  //   rearm_alone it stays there until the cause is gone, and then arms as at the start.
  // - Waiting. A waiting output trips on the device, its numbers and the map. It does not trip on a
  //   late loop or a fast hand, which pass.
  // - Clutch and swap. Both fade the output to zero and ramp it in again. The clutch arms; a swap
  //   does not, since that is for the user.
  Wrench pass(const OutputFrame& frame, double dt_s) noexcept;

  OutputState state() const { return state_; }
  bool at_zero() const { return gain_ == 0; }  // the ramp, whatever the wrench
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

}  // namespace forcelayer::loop

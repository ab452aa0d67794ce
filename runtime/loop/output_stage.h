// The output stage stands between the step's wrench and the motors. It asks the gate whether and
// how much, limits, and checks its own result last. A pure state machine: the same inputs give the
// same outputs.
#pragma once

#include <cstdint>

#include "forcelayer/frame.h"
#include "runtime/loop/output_gate.h"

namespace forcelayer::loop {

struct OutputLimits : GateLimits {
  double max_force_n = 0;
  double max_torque_nm = 0;
  double slew_s = 0.005;       // shortest rise from zero to the limits
  double max_speed_mps = 5;    // of the handle at the device: a faster hand trips the output
  double max_turn_radps = 50;  // the same for its rotation
};

// The facts of a frame on which the stage decides.
struct OutputFrame {
  Wrench wanted;          // about the handle's origin, device axes
  double speed_mps = 0;   // of the handle at the device
  double turn_radps = 0;  // the same for its rotation
  InputHealth health;
  bool faulty = false;      // the step reported a fault: bad input, or none
  bool not_finite = false;  // that fault: the input has such numbers, or the motion overflowed
  bool free_of_contact = false;
  bool unstretched = false;  // the part is registered where the coupling holds it
};

class OutputStage {
 public:
  explicit OutputStage(const OutputLimits& limits) : limits_(limits), gate_(limits) {}

  // The wrench for the device, once a frame of `dt_s`.
  // - Arming. A sound frame arms a waiting output if the part is free of contact or unstretched.
  //   The frame that arms and those of zero_s give exactly zero, as OutputWatch demands; then the
  //   output ramps in.
  // - Faults. A faulty frame gives zero, and the output ramps in anew. Faults that last longer than
  //   stale_s, or come again and again, trip the output (output_gate.h). It trips at once when the
  //   device is gone, the loop late, the wrench not finite or the hand too fast.
  // - Trips. A tripped output stays at zero until the user presses and releases the clutch. With
  //   rearm_alone it stays there until the cause is gone, and then arms as at the start.
  // - Waiting. A waiting output trips on the device and its numbers. It does not trip on a
  //   late loop or a fast hand, which pass.
  // - Clutch and swap. Both fade the output to zero and ramp it in again. The clutch arms; a swap
  //   does not, since that is for the user.
  Wrench pass(const OutputFrame& frame, double dt_s) noexcept;

  OutputState state() const;
  bool at_zero() const { return gate_.gain() == 0; }  // the ramp, whatever the wrench
  TripCause last_trip() const { return gate_.last_trip(); }
  std::uint64_t trips() const { return gate_.trips(); }
  const OutputGate& gate() const { return gate_; }
  const OutputLimits& limits() const { return limits_; }

 private:
  TripCause cause_to_trip(const OutputFrame& frame) const noexcept;
  Wrench limited(const Wrench& wanted, double gain) const noexcept;
  Wrench slewed(const Wrench& wanted, double dt_s) const noexcept;
  bool allowed(const Wrench& wrench) const noexcept;

  OutputLimits limits_;
  OutputGate gate_;
  Wrench last_;
};

}  // namespace forcelayer::loop

// What stands between the step's wrench and the motors: arming, ramps, limits, and the way to fail
// (DESIGN 7). A pure state machine: the same inputs give the same outputs.
#pragma once

#include <cstdint>

#include "runtime/pose.h"

namespace forcelayer {

struct OutputLimits {
  double max_force_n = 0;
  double max_torque_nm = 0;
  double ramp_s = 0.2;       // from zero to full output after arming
  double slew_s = 0.005;     // full output cannot rise from zero in less
  double max_speed_mps = 5;  // of the handle at the device: beyond it the output trips
  double stale_s = 0.005;    // input may be missing for so long before the output trips
  bool rearm_alone = true;   // arm again without the user once a trip's cause is gone
};

enum class OutputState : std::uint32_t {
  kWaiting,  // not armed: zero
  kArmed,    // ramping in or at full output
  kTripped,  // latched at zero until armed again
};

// Why the output tripped last.
enum class TripCause : std::uint32_t { kNone, kStaleInput, kOverSpeed, kNotFinite };

const char* to_text(TripCause cause);

// What the stage must know of a frame.
struct OutputFrame {
  Wrench wanted;         // about the handle's origin, device axes
  double speed_mps = 0;  // of the handle at the device
  bool faulty = false;   // the step reported a fault: bad input, or none
  bool free_of_contact = false;
  bool unstretched = false;  // the part is registered where the coupling holds it
};

class OutputStage {
 public:
  explicit OutputStage(const OutputLimits& limits) : limits_(limits) {}

  // The wrench for the device, once a frame of `dt_s`. A fault gives zero in the same frame; where
  // it lasts longer than stale_s, or the wrench is not finite, or the hand too fast, zero until the
  // stage is armed again: when the frame is sound and the part free of contact or unstretched.
  Wrench pass(const OutputFrame& frame, double dt_s) noexcept;

  OutputState state() const { return state_; }
  TripCause last_trip() const { return last_trip_; }
  std::uint64_t trips() const { return trips_; }

 private:
  void trip(TripCause cause) noexcept;
  bool may_arm(const OutputFrame& frame) const noexcept;
  Wrench limited(const Wrench& wanted, double gain) const noexcept;
  Wrench slewed(const Wrench& wanted, double dt_s) const noexcept;

  OutputLimits limits_;
  OutputState state_ = OutputState::kWaiting;
  TripCause last_trip_ = TripCause::kNone;
  std::uint64_t trips_ = 0;
  double armed_s_ = 0;
  double faulty_s_ = 0;
  Wrench last_;
};

}  // namespace forcelayer

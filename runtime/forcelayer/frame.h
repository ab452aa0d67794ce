// One period of the loop: input, outcome and output.
#pragma once

#include <cstdint>

#include "forcelayer/input_health.h"
#include "forcelayer/step.h"

namespace forcelayer {

// Whether the device's motors get a force. The numbers stand in the pose stream.
enum class OutputState : std::uint32_t {
  kWaiting,  // not armed yet: zero
  kArmed,    // ramping in or at full output
  kTripped,  // latched at zero until armed again
};

// Why the output tripped last.
enum class TripCause : std::uint32_t {
  kNone,
  kDeviceLost,      // the device does not answer
  kNotCalibrated,   // its poses cannot be trusted
  kFrozen,          // no fresh reading within the stale limit
  kInputNotFinite,  // NaN, infinity, or no unit quaternion
  kImplausible,     // far outside the workspace, a jump, or not what its velocity says
  kOverSpeed,       // the hand moved or turned faster than the limit
  kNotFinite,       // the motion overflowed
  kLoopLate,        // a frame began later than the stale limit allows
  kOutputHeld,      // the device's own side keeps the motors at zero
};

// The cause, and what to do about it, each a part of a sentence.
const char* to_text(TripCause cause);
const char* how_to_mend(TripCause cause);

struct Frame {
  std::uint64_t number = 0;  // from 0
  double time_s = 0;         // number * dt
  StepInput input;
  InputHealth health;  // of the input
  StepResult result;
  Wrench device_wrench;    // after arming and limits: about the handle, device axes
  double to_hand_j = 0;    // work of the last frame's device_wrench on the hand until now
  double generated_j = 0;  // sum over contact episodes of the peak of the work on the hand: what a
                           // passive scene, which stores none at first, could not give
  // A path that leads the hand (voxrun --guide): its fraction of device_wrench, the work that it
  // gave the hand so far, of which generated_j has nothing, and what that may be.
  double guide_force_n = 0, guide_torque_nm = 0;
  double guide_given_j = 0, guide_allowed_j = 0;
  std::uint64_t outcome_hash = 0;  // of the wrench and the state after the step
  Pose world_from_target;          // of the centroid: where the coupling pulls the part
  std::int64_t step_ns = 0;        // of the step alone
  OutputState output = OutputState::kWaiting;
  TripCause last_trip = TripCause::kNone;
  std::uint32_t scene = 0;           // how many scenes were in use before this one
  std::uint32_t objects_before = 0;  // how many objects those had, all together
};

}  // namespace forcelayer

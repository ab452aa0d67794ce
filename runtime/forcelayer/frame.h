// One frame as the loop hands it to other threads: recorder, trace, pose stream, console.
#pragma once

#include <cstdint>

#include "forcelayer/input_health.h"
#include "forcelayer/step.h"

namespace forcelayer {

enum class OutputState : std::uint32_t {
  kWaiting,  // not armed yet: zero
  kArmed,    // ramping in or at full output
  kTripped,  // latched at zero until armed again
};

// Why the output tripped last.
enum class TripCause : std::uint32_t {
  kNone,
  kDeviceLost,
  kNotCalibrated,
  kFrozen,
  kInputNotFinite,
  kImplausible,
  kOverSpeed,
  kNotFinite,
  kLoopLate,
  kOutputHeld,
  kMapLost,
};

struct Frame {
  std::uint64_t number = 0;  // from 0
  double time_s = 0;         // number * dt
  StepInput input;
  InputHealth health;  // of the input
  StepResult result;
  Wrench device_wrench;            // after arming and limits: about the handle, device axes
  std::uint64_t outcome_hash = 0;  // of the wrench and the state after the step
  Pose world_from_target;          // of the centroid: where the coupling pulls the part
  std::int64_t step_ns = 0;        // of the step alone
  OutputState output = OutputState::kWaiting;
  TripCause last_trip = TripCause::kNone;
};

}  // namespace forcelayer

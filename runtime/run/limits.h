// The limits of input and output that a request asks for.
#pragma once

#include <algorithm>

#include "forcelayer/run.h"
#include "runtime/loop/input_source.h"
#include "runtime/loop/output_stage.h"

namespace forcelayer {

// Limit of the handle: the wrist of a hand as fast as max_speed_mps.
inline double max_turn_radps(const RunRequest& request) {
  return request.max_turn_radps.value_or(kTurnOfSpeedRadPerM * request.max_speed_mps);
}

inline loop::InputLimits input_limits(const RunRequest& request) {
  loop::InputLimits limits;
  limits.stale_s = std::min(request.stale_s, kStaleCeilingS);
  return limits;
}

inline loop::OutputLimits output_limits(const RunRequest& request, const Parameters& parameters) {
  loop::OutputLimits limits;
  limits.max_force_n = parameters.max_force_n;
  limits.max_torque_nm = parameters.max_torque_nm;
  limits.max_speed_mps = request.max_speed_mps;
  limits.max_turn_radps = max_turn_radps(request);
  limits.stale_s = std::min(request.stale_s, kStaleCeilingS);
  return limits;
}

}  // namespace forcelayer

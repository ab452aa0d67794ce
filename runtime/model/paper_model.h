// The dynamic model of 1999 to the letter (paper 3, 5.1-5.3): explicit forces, symplectic
// Newton-Euler, no guard, no velocity limit, no torque clamp, no braking torque. The yardstick.
#pragma once

#include "runtime/model/simulation.h"

namespace forcelayer::model {

// One frame: samples the map at the state's pose, adds field, braking and coupling, and integrates.
// The wrench is the reaction of the coupling on the hand; exactly zero when every point is free.
StepResult paper_step(const StepContext& context, State& state, const StepInput& input,
                      double dt_s) noexcept;

}  // namespace forcelayer::model

// The velocity at the end of a step, implicit in everything that is stiff: coupling, contacts and
// braking in one 6x6 system with an active set.
#pragma once

#include <cstdint>
#include <span>

#include "runtime/spatial.h"
#include "runtime/virtual_coupling.h"

namespace forcelayer {

// One unilateral constraint: pushes with the impulse weight * (onset - j.v) while j.v < onset.
struct ContactRow {
  Vector6 j{};        // separation speed per velocity
  double weight = 0;  // N s per m/s
  double onset = 0;   // m/s
};
static_assert(sizeof(ContactRow) == 64);

// All but the contacts: inertia, momentum before the step, and the two halves of the coupling.
struct StepSystem {
  Symmetric6 inertia;
  Vector6 momentum{};
  CouplingHalf translation, rotation;
  HalfStretch displacement, angle;
  double dt_s = 0;
};

// Minimises the step's convex energy
//   (v - v0) M (v - v0) / 2 + coupling(v) + sum weight max(0, onset - j.v)^2 / 2
// by Newton's method on the active set, from `guess`. The result is finite for finite input, and
// never worse than `guess`.
Vector6 solve_velocity(const StepSystem& system, std::span<const ContactRow> rows,
                       const Vector6& guess) noexcept;

}  // namespace forcelayer

// The velocity at the end of a step, implicit in everything that is stiff: coupling, contacts and
// braking in one 6x6 system with an active set.
#pragma once

#include "runtime/coupling/spatial.h"
#include "runtime/coupling/virtual_coupling.h"
#include "runtime/model/contact_rows.h"

namespace forcelayer::model {

// All but the contacts: inertia, momentum before the step, and the two halves of the coupling.
struct StepSystem {
  coupling::Symmetric6 inertia;
  coupling::Vector6 momentum{};
  coupling::CouplingHalf translation, rotation;
  coupling::HalfStretch displacement, angle;
  glm::dvec3 arm_m{0};  // from the centroid to the grip, where the force acts
  double dt_s = 0;
};

// Minimises the step's convex energy
//   (v - v0) M (v - v0) / 2 + coupling(v) + rows.energy_j(v)
// by Newton's method on the active set, from `guess`. The result is finite for finite input, and
// never worse than `guess` (but for the rounding of the energies themselves): a clamped coupling
// enters with a quadratic that touches its energy at the velocity so far and lies above it
// elsewhere, and a step that does not lower the sum is not made.
coupling::Vector6 solve_velocity(const StepSystem& system, ContactRows& rows,
                                 const coupling::Vector6& guess) noexcept;

}  // namespace forcelayer::model

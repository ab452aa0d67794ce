// The default model's virtual coupling: spring and damper clamped together to what the device can
// bear, in force and in torque. A finer voxel does not make it softer, as it does in the paper
// (5.2).
#pragma once

#include <glm/mat3x3.hpp>

#include "runtime/coupling/coupling.h"
#include "runtime/coupling/spatial.h"

namespace forcelayer::coupling {

// Stiffness, damping and limits of one half of the coupling; `damping` in world axes.
struct CouplingHalf {
  double stiffness = 0;   // N/m or N m/rad
  glm::dmat3 damping{0};  // N s/m or N m s/rad, positive semi-definite
  double limit = 0;       // N or N m
};

// Spring displacement of one half (target less part), and how fast its target moves.
struct HalfStretch {
  glm::dvec3 displacement{0};
  glm::dvec3 target_velocity{0};
};

// Displacement of the spring at which it alone has the force of spring and damper together, before
// the clamp: d - B (v - v_target) / k.
glm::dvec3 effective_stretch(const CouplingHalf& half, const HalfStretch& stretch,
                             const glm::dvec3& velocity) noexcept;

// Energy stored in the clamped spring, J: quadratic up to the clamp, then linear. Its slope is the
// clamped spring's force.
double spring_energy_j(const CouplingHalf& half, const glm::dvec3& displacement) noexcept;

// The clamped spring alone, N or N m.
glm::dvec3 spring_force(const CouplingHalf& half, const glm::dvec3& displacement) noexcept;

// Each adds one half, implicit over dt, to the 6x6 system of the velocities of the part's centroid:
// a force that acts at `arm_m` from the centroid (world axes), and a torque. A clamped half enters
// with its secant stiffness at `guess`, the velocity expected at the end of the step: the quadratic
// that touches the clamped energy there and lies above it elsewhere.
void add_force(const CouplingHalf& half, const HalfStretch& stretch, const glm::dvec3& arm_m,
               const Vector6& guess, double dt_s, Symmetric6& matrix, Vector6& impulse) noexcept;
void add_torque(const CouplingHalf& half, const HalfStretch& stretch, const Vector6& guess,
                double dt_s, Symmetric6& matrix, Vector6& impulse) noexcept;

}  // namespace forcelayer::coupling

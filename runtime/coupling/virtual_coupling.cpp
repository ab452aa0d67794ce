#include "runtime/coupling/virtual_coupling.h"

#include <glm/geometric.hpp>

namespace forcelayer::coupling {
namespace {

// Impulse of one half at the end of the step, the target being where it is: offset - slope v, with
// the secant of the clamp at the velocity that is expected.
struct LinearForce {
  glm::dmat3 slope;
  glm::dvec3 offset;

  LinearForce(const CouplingHalf& half, const HalfStretch& stretch, const glm::dvec3& expected,
              double dt_s)
      : slope(half.damping + glm::dmat3(dt_s * half.stiffness)),
        offset(half.stiffness * stretch.displacement + half.damping * stretch.target_velocity) {
    const double force = glm::length(offset - slope * expected);
    const double secant = force > half.limit ? half.limit / force : 1;
    slope *= dt_s * secant;
    offset *= dt_s * secant;
  }
};

}  // namespace

glm::dvec3 effective_stretch(const CouplingHalf& half, const HalfStretch& stretch,
                             const glm::dvec3& velocity) noexcept {
  return stretch.displacement -
         half.damping * (velocity - stretch.target_velocity) / half.stiffness;
}

double spring_energy_j(const CouplingHalf& half, const glm::dvec3& displacement) noexcept {
  const double length = glm::length(displacement);
  const double force = half.stiffness * length;
  if (force <= half.limit) return 0.5 * force * length;
  return half.limit * (length - 0.5 * half.limit / half.stiffness);
}

glm::dvec3 spring_force(const CouplingHalf& half, const glm::dvec3& displacement) noexcept {
  const glm::dvec3 force = half.stiffness * displacement;
  const double length = glm::length(force);
  return length > half.limit ? force * (half.limit / length) : force;
}

void add_force(const CouplingHalf& half, const HalfStretch& stretch, const glm::dvec3& arm_m,
               const Vector6& guess, double dt_s, Symmetric6& matrix, Vector6& impulse) noexcept {
  const LinearForce force(half, stretch,
                          linear_part(guess) + glm::cross(angular_part(guess), arm_m), dt_s);
  add_at_arm(force.slope, arm_m, matrix);
  const glm::dvec3 angular = glm::cross(arm_m, force.offset);
  for (int axis = 0; axis < 3; ++axis) {
    impulse[axis] += force.offset[axis];
    impulse[3 + axis] += angular[axis];
  }
}

void add_torque(const CouplingHalf& half, const HalfStretch& stretch, const Vector6& guess,
                double dt_s, Symmetric6& matrix, Vector6& impulse) noexcept {
  const LinearForce torque(half, stretch, angular_part(guess), dt_s);
  add_block(torque.slope, 3, matrix);
  for (int axis = 0; axis < 3; ++axis) impulse[3 + axis] += torque.offset[axis];
}

}  // namespace forcelayer::coupling

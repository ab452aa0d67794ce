#include "runtime/coupling/virtual_coupling.h"

#include <glm/geometric.hpp>

namespace forcelayer::coupling {

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

bool add_implicit(const CouplingHalf& half, const HalfStretch& stretch, const glm::dvec3& guess,
                  double dt_s, int first, Symmetric6& matrix, Vector6& impulse) noexcept {
  // Force at the end of the step, the target being where it is: offset - slope v.
  const glm::dmat3 slope = half.damping + glm::dmat3(dt_s * half.stiffness);
  const glm::dvec3 offset =
      half.stiffness * stretch.displacement + half.damping * stretch.target_velocity;
  const double expected = glm::length(offset - slope * guess);
  const double secant = expected > half.limit ? half.limit / expected : 1;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column <= row; ++column) {
      matrix.lower[Symmetric6::at(first + row, first + column)] +=
          dt_s * secant * slope[column][row];
    }
    impulse[first + row] += dt_s * secant * offset[row];
  }
  return secant < 1;
}

}  // namespace forcelayer::coupling

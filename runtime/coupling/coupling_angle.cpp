#include "runtime/coupling/coupling_angle.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"

namespace forcelayer::coupling {

glm::dvec3 continuous_angle(const glm::dquat& part, const glm::dquat& target,
                            const glm::dvec3& last) noexcept {
  const glm::dvec3 shorter = rotation_vector(target * glm::conjugate(part));
  const double angle = glm::length(shorter);
  if (angle < 1e-9) return shorter;
  const glm::dvec3 longer = shorter * ((angle - 2 * M_PI) / angle);
  const glm::dvec3 a = shorter - last, b = longer - last;
  return glm::dot(b, b) < glm::dot(a, a) ? longer : shorter;
}

double torque_fraction(double angle_rad) noexcept {
  const double beyond = std::max(0.0, angle_rad - kFullTorqueRad);
  return std::max(0.0, 1 - beyond / (2 * M_PI - kFullTorqueRad));
}

double faded_angle_rad(double angle_rad) noexcept {
  const double fade = 2 * M_PI - kFullTorqueRad;
  const double beyond = std::clamp(angle_rad - kFullTorqueRad, 0.0, fade);
  return beyond - beyond * beyond / (2 * fade);
}

}  // namespace forcelayer::coupling

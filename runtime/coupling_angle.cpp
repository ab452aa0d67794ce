#include "runtime/coupling_angle.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "runtime/coupling.h"

namespace forcelayer {

glm::dvec3 continuous_angle(const Pose& world_from_center, const Pose& world_from_target,
                            const glm::dvec3& last) noexcept {
  const glm::dvec3 shorter = rotation_vector(world_from_target.orientation *
                                             glm::conjugate(world_from_center.orientation));
  const double angle = glm::length(shorter);
  if (angle < 1e-9) return shorter;
  const glm::dvec3 longer = shorter * ((angle - 2 * M_PI) / angle);
  const glm::dvec3 a = shorter - last, b = longer - last;
  return glm::dot(b, b) < glm::dot(a, a) ? longer : shorter;
}

}  // namespace forcelayer

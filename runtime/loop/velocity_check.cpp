#include "runtime/loop/velocity_check.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"

namespace forcelayer::loop {

bool VelocityCheck::Sum::takes(const glm::dvec3& moved, const glm::dvec3& claim, double noise,
                               double dt_s) noexcept {
  const double kept = std::exp(-dt_s / kForgetS);
  fastest = std::max(fastest * kept, glm::length(moved) / dt_s);
  const glm::dvec3 next = ahead * kept + claim * dt_s - moved;
  const bool can_be = glm::length(next) <= noise + (kLagS + dt_s) * fastest;  // not for NaN
  ahead = can_be ? next : ahead * kept;
  return can_be;
}

bool VelocityCheck::believes(const Pose& device_from_handle, const Twist& claim,
                             double dt_s) noexcept {
  if (!known_) {
    known_ = true;
    last_ = device_from_handle;
    return true;
  }
  const glm::dvec3 moved_m = device_from_handle.position_m - last_.position_m;
  const glm::dvec3 turned_rad =
      coupling::rotation_vector(device_from_handle.orientation * glm::conjugate(last_.orientation));
  last_ = device_from_handle;
  const bool linear = linear_.takes(moved_m, claim.linear_mps, kNoiseM, dt_s);
  const bool angular = angular_.takes(turned_rad, claim.angular_radps, kNoiseRad, dt_s);
  return linear && angular;
}

}  // namespace forcelayer::loop

#include "runtime/handle_velocity.h"

#include <glm/geometric.hpp>

#include "runtime/coupling.h"

namespace forcelayer {

Twist HandleVelocity::update(const Pose& world_from_handle, double dt_s) noexcept {
  if (!known_) {
    known_ = true;
    last_ = world_from_handle;
    velocity_ = {};
    return velocity_;
  }
  const glm::dvec3 linear_mps = (world_from_handle.position_m - last_.position_m) / dt_s;
  const glm::dvec3 angular_radps =
      rotation_vector(world_from_handle.orientation * glm::conjugate(last_.orientation)) / dt_s;
  last_ = world_from_handle;
  const bool jump =
      !(glm::length(linear_mps) <= kMaxSpeedMps) || !(glm::length(angular_radps) <= kMaxTurnRadps);
  if (jump) {
    velocity_ = {};
    return velocity_;
  }
  const double share = dt_s / (dt_s + kTimeConstantS);
  velocity_.linear_mps += (linear_mps - velocity_.linear_mps) * share;
  velocity_.angular_radps += (angular_radps - velocity_.angular_radps) * share;
  return velocity_;
}

}  // namespace forcelayer

#include "runtime/coupling/coupling.h"

#include <cmath>
#include <glm/geometric.hpp>

namespace forcelayer::coupling {

CouplingTarget coupling_target(const State& state, const StepInput& input) noexcept {
  CouplingTarget target;
  target.world_from_center = input.world_from_handle * state.handle_from_center;
  const glm::dvec3 arm_m = target.world_from_center.position_m - input.world_from_handle.position_m;
  target.velocity.angular_radps = input.handle_velocity.angular_radps;
  target.velocity.linear_mps =
      input.handle_velocity.linear_mps + glm::cross(input.handle_velocity.angular_radps, arm_m);
  return target;
}

CouplingStretch coupling_stretch(const State& state, const CouplingTarget& target) noexcept {
  const Pose& part = state.world_from_center;
  return {
      target.world_from_center.position_m - part.position_m,
      rotation_vector(target.world_from_center.orientation * glm::conjugate(part.orientation)),
      state.velocity.linear_mps - target.velocity.linear_mps,
      state.velocity.angular_radps - target.velocity.angular_radps,
  };
}

GripTarget grip_target(const State& state, const StepInput& input) noexcept {
  const Pose& grip = state.handle_from_center;
  const Pose& hand = input.world_from_handle;
  GripTarget target{hand.position_m, hand.orientation * grip.orientation, input.handle_velocity,
                    -(glm::conjugate(grip.orientation) * grip.position_m)};
  if (state.has_handle != 0) {
    const Pose& last = state.world_from_handle;
    target.shift_m = hand.position_m - last.position_m;
    target.turn_rad = rotation_vector(hand.orientation * glm::conjugate(last.orientation));
  }
  return target;
}

GripTarget earlier(const GripTarget& target, double left_fraction) noexcept {
  GripTarget before = target;
  before.point_m -= left_fraction * target.shift_m;
  before.orientation = rotation_by(-left_fraction * target.turn_rad) * target.orientation;
  return before;
}

glm::dvec3 rotation_vector(const glm::dquat& rotation) noexcept {
  const glm::dvec3 axis(rotation.x, rotation.y, rotation.z);
  const double sine = glm::length(axis);  // of the half-angle
  // Below this the angle is 2 |axis| to the last bit, and dividing by it would lose more.
  if (sine < 1e-9) return axis * (rotation.w < 0 ? -2.0 : 2.0);
  // q and -q are the same rotation: the one with w >= 0 turns by at most pi.
  const double angle = 2 * std::atan2(sine, std::abs(rotation.w));
  return axis * ((rotation.w < 0 ? -angle : angle) / sine);
}

glm::dquat rotation_by(const glm::dvec3& rotation_rad) noexcept {
  const double angle = glm::length(rotation_rad);
  // sin(x/2)/x: its series is exact to the last bit below 1e-4, where the quotient is not.
  const double scale = angle < 1e-4 ? 0.5 - angle * angle / 48 : std::sin(angle / 2) / angle;
  const glm::dvec3 axis = rotation_rad * scale;
  return {std::cos(angle / 2), axis.x, axis.y, axis.z};
}

}  // namespace forcelayer::coupling

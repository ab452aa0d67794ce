#include "forcelayer/placement.h"

namespace forcelayer {

Pose DevicePlacement::world_from_handle(const Pose& device_from_handle) const noexcept {
  return world_from_device *
         Pose{motion_scale * device_from_handle.position_m, device_from_handle.orientation};
}

Pose DevicePlacement::device_from_handle(const Pose& world_from_handle) const noexcept {
  Pose handle = inverse(world_from_device) * world_from_handle;
  handle.position_m /= motion_scale;
  return handle;
}

Twist DevicePlacement::world_twist(const Twist& device_twist) const noexcept {
  const glm::dquat& world_from_axes = world_from_device.orientation;
  return {world_from_axes * (motion_scale * device_twist.linear_mps),
          world_from_axes * device_twist.angular_radps};
}

Twist DevicePlacement::device_twist(const Twist& world_twist) const noexcept {
  const glm::dquat device_from_axes = glm::conjugate(world_from_device.orientation);
  return {device_from_axes * world_twist.linear_mps / motion_scale,
          device_from_axes * world_twist.angular_radps};
}

Wrench DevicePlacement::device_wrench(const Wrench& on_hand) const noexcept {
  const glm::dquat device_from_axes = glm::conjugate(world_from_device.orientation);
  return {device_from_axes * (motion_scale * on_hand.force_n),
          device_from_axes * on_hand.torque_nm};
}

}  // namespace forcelayer

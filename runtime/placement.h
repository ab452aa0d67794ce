// Placing the device in the scene, and carrying the wrench back to it (DESIGN 6, Frames).
#pragma once

#include "runtime/pose.h"

namespace forcelayer {

struct DevicePlacement {
  Pose world_from_device;
  double motion_scale = 1;  // scene metres a metre of the device; rotations are never scaled

  Pose world_from_handle(const Pose& device_from_handle) const noexcept;
  Pose device_from_handle(const Pose& world_from_handle) const noexcept;
  Twist world_twist(const Twist& device_twist) const noexcept;

  // `on_hand` acts at `point_m` (world axes, torque about that point); the result is about the
  // handle's origin in device axes. The force is not scaled: the hand feels the coupling's
  // stiffness times motion_scale.
  Wrench device_wrench(const Wrench& on_hand, const glm::dvec3& point_m,
                       const glm::dvec3& handle_m) const noexcept;
};

}  // namespace forcelayer

// Where the device stands in the scene, and where the part begins.
#pragma once

#include <optional>

#include "forcelayer/pose.h"

namespace forcelayer {

struct DevicePlacement {
  Pose world_from_device;
  double motion_scale = 1;  // c: scene meters a meter of the device; rotations are never scaled

  Pose world_from_handle(const Pose& device_from_handle) const noexcept;
  Pose device_from_handle(const Pose& world_from_handle) const noexcept;
  Twist world_twist(const Twist& device_twist) const noexcept;
  Twist device_twist(const Twist& world_twist) const noexcept;

  // The scene's wrench on the hand (world axes, about the handle's origin) as the device gives it
  // (device axes, about the same). The scale is a transformer: way divided by c, force times c,
  // torque unchanged, so that work at the device is work in the scene. The hand feels a stiffness,
  // a damping or a mass of the scene times c^2.
  Wrench device_wrench(const Wrench& on_hand) const noexcept;
};

// Where the part begins: in the scene, in the hand, or both. With one of them, or none, the hand
// holds it without stretch; with both, the coupling pulls it to where the grip has it, and the
// output does not arm before the part is free of contact.
struct PartStart {
  std::optional<Pose> world_from_part;   // none: where the grip has it
  std::optional<Pose> handle_from_part;  // the grip; none: whatever holds it without stretch, and
                                         // the identity where the place is not given either
  // Where the part is installed, world_from_part: there it may touch what it touches, and come so
  // near to those objects until it has left them (runtime/guard/seat.h). None: where it starts.
  std::optional<Pose> world_from_seat = std::nullopt;
};

}  // namespace forcelayer

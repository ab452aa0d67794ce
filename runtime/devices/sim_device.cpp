#include "runtime/devices/sim_device.h"

namespace forcelayer {

DeviceCapabilities sim_capabilities() {
  DeviceCapabilities device;
  device.name = "sim";
  device.max_force_n = 15;
  device.max_torque_nm = 0.1;
  device.damping_ns_per_m = 2;
  device.damping_nms_per_rad = 0.005;
  device.delay_s = 0.001;
  device.senses_velocity = true;
  device.watchdog_s = 0.001;  // it cannot outlive the host
  return device;
}

SimDevice::SimDevice(MotionScript script, const DevicePlacement& placement)
    : script_(std::move(script)), placement_(placement) {}

DeviceSample SimDevice::read(double time_s) noexcept {
  DeviceSample sample;
  sample.device_from_handle = placement_.device_from_handle(script_.pose(time_s));
  const Twist world = script_.velocity(time_s);
  const glm::dquat device_from_axes = glm::conjugate(placement_.world_from_device.orientation);
  sample.velocity = {device_from_axes * world.linear_mps / placement_.motion_scale,
                     device_from_axes * world.angular_radps};
  sample.fresh = sample.present = true;
  sample.sequence = ++sequence_;
  return sample;
}

}  // namespace forcelayer

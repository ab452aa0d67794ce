#include "runtime/devices/sim_device.h"

namespace forcelayer::devices {

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
  sample.velocity = placement_.device_twist(script_.velocity(time_s));
  sample.fresh = sample.present = true;
  sample.sequence = ++sequence_;
  return sample;
}

DeviceCapabilities hand_capabilities(const SimHandParameters& hand) {
  DeviceCapabilities device = sim_capabilities();
  device.damping_ns_per_m = hand.device_damping_ns_per_m;
  device.damping_nms_per_rad = hand.device_damping_nms_per_rad;
  device.friction_n = hand.device_friction_n;
  device.friction_nm = hand.device_friction_nm;
  device.encoder_step_m = hand.encoder_step_m;
  device.encoder_step_rad = hand.encoder_step_rad;
  device.apparent_mass_kg = hand.device_mass_kg;
  device.apparent_inertia_kgm2 = hand.device_inertia_kgm2;
  device.delay_s = hand.delay_s;
  device.senses_velocity = false;  // encoders only
  return device;
}

SimHandDevice::SimHandDevice(MotionScript script, const DevicePlacement& placement,
                             const SimHandParameters& hand)
    : capabilities_(hand_capabilities(hand)),
      script_(std::move(script)),
      placement_(placement),
      hand_(hand, placement_.device_from_handle(script_.pose(0))) {}

DeviceSample SimHandDevice::read(double time_s) noexcept {
  const Pose wanted = placement_.device_from_handle(script_.pose(time_s));
  const double passed_s = time_s - time_s_;
  DeviceSample sample;
  sample.device_from_handle = passed_s > 0 ? hand_.step(wanted, output_, passed_s) : hand_.pose();
  time_s_ = time_s;
  sample.fresh = sample.present = true;
  sample.sequence = ++sequence_;
  return sample;
}

}  // namespace forcelayer::devices

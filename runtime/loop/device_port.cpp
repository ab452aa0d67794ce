#include "runtime/loop/device_port.h"

namespace forcelayer::loop {

void DevicePort::arrive(const Pose& device_from_handle, bool in_contact) noexcept {
  to_hand_j_ = known_ ? coupling::held_work_j(held_, handle_, device_from_handle) : 0;
  coupling::add_given(energy_, to_hand_j_);
  if (!in_contact) coupling::end_episode(energy_);
  handle_ = device_from_handle;
  known_ = true;
}

void DevicePort::lose_handle() noexcept {
  to_hand_j_ = 0;
  known_ = false;
}

Wrench DevicePort::damping(const Twist& device_velocity, double radius_m, double limit_ns_per_m,
                           double dt_s) noexcept {
  if (!(limit_ns_per_m > 0 && dt_s > 0)) return {};
  return coupling::passivity_damping(energy_, device_velocity, radius_m, limit_ns_per_m, dt_s);
}

}  // namespace forcelayer::loop

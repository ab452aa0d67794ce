#include "runtime/input_source.h"

namespace forcelayer {

bool DeviceInput::next(double time_s, double dt_s, StepInput& input) noexcept {
  const DeviceSample sample = device_.read(time_s);
  input.world_from_handle = placement_.world_from_handle(sample.device_from_handle);
  input.buttons = sample.buttons;
  input.valid = sample.present ? 1 : 0;
  if (!sample.present) {
    velocity_.reset();
    input.handle_velocity = {};
  } else if (device_.capabilities().senses_velocity) {
    input.handle_velocity = placement_.world_twist(sample.velocity);
  } else {
    input.handle_velocity = velocity_.update(input.world_from_handle, dt_s);
  }
  return true;
}

}  // namespace forcelayer

#include "runtime/loop/callback_servo.h"

#include "runtime/machine/real_time.h"

namespace forcelayer {

OutputLimits output_limits(const Parameters& parameters) {
  OutputLimits limits;
  limits.max_force_n = parameters.max_force_n;
  limits.max_torque_nm = parameters.max_torque_nm;
  return limits;
}

class CallbackServo::HostDevice final : public Device {
 public:
  explicit HostDevice(const DeviceCapabilities& device) : capabilities_(device) {}
  const DeviceCapabilities& capabilities() const override { return capabilities_; }
  Status start() override { return {}; }
  DeviceSample read(double) noexcept override { return reading; }
  void write(const Wrench& device_wrench) noexcept override { wrench = device_wrench; }
  void stop() noexcept override { wrench = {}; }

  DeviceSample reading;
  Wrench wrench;

 private:
  DeviceCapabilities capabilities_;
};

CallbackServo::CallbackServo(Simulation& simulation, const DeviceCapabilities& device,
                             const DevicePlacement& placement, const PartStart& start,
                             const DeviceSample& first, const OutputLimits& limits,
                             const InputLimits& input_limits)
    : stale_s_(limits.stale_s),
      device_(std::make_unique<HostDevice>(device)),
      input_(std::make_unique<DeviceInput>(*device_, placement, input_limits)),
      statistics_(std::make_unique<LoopStatistics>()) {
  const Pose world_from_handle = placement.world_from_handle(made_unit(first.device_from_handle));
  servo_ = std::make_unique<Servo>(simulation, *input_,
                                   simulation.registered(start, world_from_handle), limits);
}

CallbackServo::~CallbackServo() = default;

Wrench CallbackServo::call(const DeviceSample& reading) noexcept {
  const long long now_ns = monotonic_ns();
  const double late_s = static_cast<double>(now_ns - last_ns_) / 1e9 - servo_->dt_s();
  if (last_ns_ != 0 && late_s > stale_s_) servo_->note_late();
  last_ns_ = now_ns;
  device_->reading = reading;
  servo_->tick(frame_);
  statistics_->count(frame_);
  return device_->wrench;
}

}  // namespace forcelayer

// A device with motors whose readings a test writes.
#pragma once

#include "forcelayer/run.h"
#include "runtime/devices/device.h"
#include "runtime/loop/output_stage.h"

namespace forcelayer::test {

inline constexpr double kPuppetForceN = 10, kPuppetTorqueNm = 0.1;  // the most that it gives

inline DeviceCapabilities puppet_capabilities() {
  DeviceCapabilities device;
  device.name = "puppet";
  device.max_force_n = kPuppetForceN;
  device.max_torque_nm = kPuppetTorqueNm;
  device.damping_ns_per_m = 2;
  device.damping_nms_per_rad = 0.005;
  device.delay_s = 0.001;
  device.workspace_radius_m = 0.5;
  device.rate_hz = 1000;
  device.watchdog_s = 0.02;
  device.hardware = true;
  return device;
}

inline loop::OutputLimits puppet_limits() {
  loop::OutputLimits limits;
  limits.max_force_n = kPuppetForceN;
  limits.max_torque_nm = kPuppetTorqueNm;
  return limits;
}

class PuppetDevice final : public devices::Device {
 public:
  const DeviceCapabilities& capabilities() const override { return capabilities_; }
  Status start() override { return {}; }
  DeviceSample read(double) noexcept override { return sample; }
  void write(const Wrench& wrench) noexcept override { felt = wrench; }
  void stop() noexcept override { felt = {}; }

  void rate(double hz) { capabilities_.rate_hz = hz; }
  void senses_velocity(bool senses) { capabilities_.senses_velocity = senses; }

  DeviceSample sample;
  Wrench felt;

 private:
  DeviceCapabilities capabilities_ = puppet_capabilities();
};

}  // namespace forcelayer::test

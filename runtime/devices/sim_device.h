// The simulated device: a hand that follows a script, and feels nothing.
#pragma once

#include "forcelayer/placement.h"
#include "runtime/devices/device.h"
#include "runtime/devices/motion_script.h"

namespace forcelayer {

// Ratings at which the paper ran its device (6.4: 15 N, 0.1 N m), with the damping and the frame of
// delay that such devices show: 2 N s/m and 1 ms let it render 1333 N/m.
DeviceCapabilities sim_capabilities();

class SimDevice final : public Device {
 public:
  // The script's poses are world_from_handle; the device reports them in its own frame.
  SimDevice(MotionScript script, const DevicePlacement& placement);

  const DeviceCapabilities& capabilities() const override { return capabilities_; }
  Status start() override { return {}; }
  DeviceSample read(double time_s) noexcept override;
  void write(const Wrench& device_wrench) noexcept override { last_wrench_ = device_wrench; }
  void stop() noexcept override { last_wrench_ = {}; }

  const Wrench& last_wrench() const { return last_wrench_; }

 private:
  DeviceCapabilities capabilities_ = sim_capabilities();
  MotionScript script_;
  DevicePlacement placement_;
  Wrench last_wrench_;
  std::uint64_t sequence_ = 0;
};

}  // namespace forcelayer

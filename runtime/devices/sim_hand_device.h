// The simulated device with a simulated hand on it: the hand follows a script, and feels the loop.
#pragma once

#include "forcelayer/placement.h"
#include "runtime/devices/device.h"
#include "runtime/devices/motion_script.h"
#include "runtime/devices/sim_hand.h"

namespace forcelayer {

// What a loop may know of a device with these mechanics: the simulated device's ratings, the
// device's own damping (the hand may let go) and its delay.
DeviceCapabilities hand_capabilities(const SimHandParameters& hand);

class SimHandDevice final : public Device {
 public:
  // The script's poses, world_from_handle, are where the hand wants the handle.
  SimHandDevice(MotionScript script, const DevicePlacement& placement,
                const SimHandParameters& hand);

  const DeviceCapabilities& capabilities() const override { return capabilities_; }
  Status start() override { return {}; }
  DeviceSample read(double time_s) noexcept override;
  void write(const Wrench& device_wrench) noexcept override { output_ = device_wrench; }
  void stop() noexcept override { output_ = {}; }

 private:
  DeviceCapabilities capabilities_;
  MotionScript script_;
  DevicePlacement placement_;
  SimHand hand_;
  Wrench output_;
  double time_s_ = 0;
  std::uint64_t sequence_ = 0;
};

}  // namespace forcelayer

// The simulated devices: a handle that follows a script exactly, and a hand on a handle, which
// follows the script and feels the loop.
#pragma once

#include "forcelayer/placement.h"
#include "runtime/devices/device.h"
#include "runtime/devices/motion_script.h"
#include "runtime/devices/sim_hand.h"

namespace forcelayer::devices {

// Ratings at which the paper ran its device (6.4: 15 N, 0.1 N m), with the damping and the frame of
// delay that such devices show: 2 N s/m and 1 ms let it render 1333 N/m.
DeviceCapabilities sim_capabilities();

// The handle is where the script has it, whatever the loop answers.
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

// A device with these mechanics, as it would declare itself: the ratings of sim_capabilities(), the
// device's own damping (the hand may let go) and its delay.
DeviceCapabilities hand_capabilities(const SimHandParameters& hand);

// A simulated hand pulls the handle after the script, and the wrench moves both.
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

}  // namespace forcelayer::devices

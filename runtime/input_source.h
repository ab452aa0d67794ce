// Where the inputs of the steps come from: a device in its place, or a recording.
#pragma once

#include <memory>

#include "runtime/devices/device.h"
#include "runtime/frame.h"
#include "runtime/handle_velocity.h"
#include "runtime/placement.h"

namespace forcelayer {

class InputSource {
 public:
  virtual ~InputSource() = default;

  // The input of the frame at loop time `time_s`. Called once a frame, in order, by the loop alone;
  // never blocks. False at the end, where there is one.
  virtual bool next(double time_s, double dt_s, StepInput& input) noexcept = 0;

  // What came of that frame, its device wrench to be felt. Once a frame, after next().
  virtual void output(const Frame& frame) noexcept = 0;

  // Zero to the hand, at once.
  virtual void silence() noexcept = 0;

  virtual const DevicePlacement& placement() const = 0;
};

// A device, placed in the scene; estimates the velocity where the device does not sense it.
class DeviceInput final : public InputSource {
 public:
  // `device` must be started, and outlive this.
  DeviceInput(Device& device, const DevicePlacement& placement)
      : device_(device), placement_(placement) {}

  bool next(double time_s, double dt_s, StepInput& input) noexcept override;
  void output(const Frame& frame) noexcept override { device_.write(frame.device_wrench); }
  void silence() noexcept override { device_.write({}); }
  const DevicePlacement& placement() const override { return placement_; }

 private:
  Device& device_;
  DevicePlacement placement_;
  HandleVelocity velocity_;
};

}  // namespace forcelayer

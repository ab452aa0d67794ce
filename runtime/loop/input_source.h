// Where the inputs of the steps come from: a device in its place, or a recording.
#pragma once

#include <memory>

#include "forcelayer/frame.h"
#include "forcelayer/placement.h"
#include "forcelayer/stale_limit.h"
#include "runtime/devices/device.h"
#include "runtime/loop/handle_velocity.h"

namespace forcelayer {

class InputSource {
 public:
  virtual ~InputSource() = default;

  // The input of the frame at loop time `time_s`. Called once a frame, in order, by the loop alone;
  // never blocks. False at the end, where there is one.
  virtual bool next(double time_s, double dt_s, StepInput& input) noexcept = 0;

  // What is the matter with that input.
  virtual InputHealth health() const noexcept { return {}; }

  // What came of that frame, its device wrench to be felt. Once a frame, after next().
  virtual void output(const Frame& frame) noexcept = 0;

  // Zero to the hand, at once.
  virtual void silence() noexcept = 0;

  virtual const DevicePlacement& placement() const = 0;
};

// When a device's readings are not to be believed.
struct InputLimits {
  double stale_s = kStaleLimitS;  // without a fresh reading; at least 2.5 of its periods
  double max_jump_mps = HandleVelocity::kMaxSpeedMps;  // between readings of hardware
  double workspace_reach = 2;  // farther out than so many radii is another unit
};

// A device, placed in the scene; estimates the velocity where the device does not sense it, and
// refuses readings that are old or cannot be.
class DeviceInput final : public InputSource {
 public:
  // `device` must be started, and outlive this.
  DeviceInput(Device& device, const DevicePlacement& placement, const InputLimits& limits = {});

  bool next(double time_s, double dt_s, StepInput& input) noexcept override;
  InputHealth health() const noexcept override { return health_; }
  void output(const Frame& frame) noexcept override { device_.write(frame.device_wrench); }
  void silence() noexcept override { device_.write({}); }
  const DevicePlacement& placement() const override { return placement_; }

 private:
  InputTrouble trouble(const DeviceSample& sample, double dt_s) noexcept;
  Twist velocity(const DeviceSample& sample, double dt_s) noexcept;  // device axes

  Device& device_;
  DevicePlacement placement_;
  InputLimits limits_;
  HandleVelocity velocity_;
  Twist estimate_;            // of the last fresh reading, device axes
  double since_fresh_s_ = 0;  // of that reading
  InputHealth health_;
  double age_s_ = 0;           // of the reading
  double since_good_s_ = 0;    // of the last one that was believed
  glm::dvec3 last_good_m_{0};  // its position
  bool has_good_ = false;
};

// Whether a device's pose is one: finite, and a rotation but for the few bits in which it came.
bool is_pose(const Pose& device_from_handle) noexcept;

// That pose with its rotation made unit; what is unit already keeps its bits.
Pose made_unit(const Pose& device_from_handle) noexcept;

// Whether `position_m`, device axes, lies so far outside the workspace that its unit must be wrong.
// Never where the device declares no workspace.
bool outside_workspace(const DeviceCapabilities& device, const glm::dvec3& position_m,
                       double reach) noexcept;

// The same for the pose with which a run begins: kDeviceRefused, with a hint at units.
Status check_workspace(const DeviceCapabilities& device, const Pose& device_from_handle);

}  // namespace forcelayer

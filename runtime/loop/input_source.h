// Sources of a step's input: a device that is placed in the scene, or a recording.
#pragma once

#include <memory>

#include "forcelayer/frame.h"
#include "forcelayer/placement.h"
#include "forcelayer/stale_limit.h"
#include "runtime/devices/device.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/loop/velocity_check.h"

namespace forcelayer::loop {

class InputSource {
 public:
  virtual ~InputSource() = default;

  // The input of the frame at loop time `time_s`. Called once a frame, in order, by the loop alone;
  // never blocks. False at the end, where there is one.
  virtual bool next(double time_s, double dt_s, StepInput& input) noexcept = 0;

  // The health of that input.
  virtual InputHealth health() const noexcept { return {}; }

  // Takes the frame's outcome; a device gives its wrench to the hand. Once a frame, after next().
  virtual void output(const Frame& frame) noexcept = 0;

  // Zero to the hand, at once.
  virtual void silence() noexcept = 0;

  virtual const DevicePlacement& placement() const = 0;
};

// Limits beyond which a reading is refused.
struct InputLimits {
  double stale_s = kStaleLimitS;  // without a fresh reading; at least kStalePeriods
  double max_jump_mps = HandleVelocity::kMaxSpeedMps;     // between readings of hardware
  double max_turn_radps = HandleVelocity::kMaxTurnRadps;  // the same for its rotation
  double workspace_reach = 2;  // in workspace radii: a pose farther out is in another unit
};

// A device that is placed in the scene. Refuses readings that are old or implausible, holds a
// sensed velocity of hardware against its poses, and estimates the velocity where it is not sensed.
class DeviceInput final : public InputSource {
 public:
  // `device` must be started, and outlive this.
  DeviceInput(devices::Device& device, const DevicePlacement& placement,
              const InputLimits& limits = {});

  bool next(double time_s, double dt_s, StepInput& input) noexcept override;
  InputHealth health() const noexcept override { return health_; }
  void output(const Frame& frame) noexcept override { device_.write(frame.device_wrench); }
  void silence() noexcept override { device_.write({}); }
  const DevicePlacement& placement() const override { return placement_; }

 private:
  InputTrouble trouble(const DeviceSample& sample, double dt_s) noexcept;
  bool jumped(const Pose& device_from_handle, double dt_s) const noexcept;
  bool claims_too_much(const DeviceSample& sample) noexcept;
  Twist velocity(const DeviceSample& sample) noexcept;  // device axes
  void forget() noexcept;

  devices::Device& device_;
  DevicePlacement placement_;
  InputLimits limits_;
  HandleVelocity velocity_;
  VelocityCheck check_;  // of sensed velocities
  double since_checked_s_ = 0;
  bool unshown_ = false;      // no pose shows yet whether the sensed velocity can be
  Twist estimate_;            // sensed or estimated at the last fresh reading, device axes
  double since_fresh_s_ = 0;  // age of that reading
  InputHealth health_;
  double output_falls_ = 0;  // DeviceSample::output_falls in the last frame
  double age_s_ = 0;         // of the newest reading
  double since_good_s_ = 0;  // age of the last accepted reading
  Pose last_good_;           // its pose
  bool has_good_ = false;
};

// Whether the numbers are a pose: finite, with a quaternion that is unit to a device's precision.
bool is_pose(const Pose& device_from_handle) noexcept;

// The pose with its quaternion made unit. A quaternion that is unit already keeps its bits.
Pose made_unit(const Pose& device_from_handle) noexcept;

// Whether `position_m`, device axes, lies so far outside the workspace that its unit must be wrong.
// Never where the device declares no workspace.
bool outside_workspace(const DeviceCapabilities& device, const glm::dvec3& position_m,
                       double reach) noexcept;

// The same test for the first pose of a run. Error: kDeviceRefused, with a hint at units.
Status check_workspace(const DeviceCapabilities& device, const Pose& device_from_handle);

}  // namespace forcelayer::loop

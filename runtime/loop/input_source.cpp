#include "runtime/loop/input_source.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>

#include "runtime/model/vectors.h"

namespace forcelayer::loop {
namespace {

constexpr double kUnitTolerance = 1e-3;  // of a quaternion's length; a device's floats err by 1e-7
constexpr double kLeastPeriods = 2.5;    // stale limit of a slow device, in its own periods
constexpr double kLeastJumpM = 0.001;    // noise and quantization of the coarsest device

}  // namespace

bool is_pose(const Pose& device_from_handle) noexcept {
  return model::is_finite(device_from_handle) &&
         model::is_unit(device_from_handle.orientation, kUnitTolerance);
}

Pose made_unit(const Pose& device_from_handle) noexcept {
  const glm::dquat& q = device_from_handle.orientation;
  if (!(std::abs(glm::dot(q, q) - 1) > 1e-12)) return device_from_handle;
  return {device_from_handle.position_m, glm::normalize(q)};
}

bool outside_workspace(const DeviceCapabilities& device, const glm::dvec3& position_m,
                       double reach) noexcept {
  return device.workspace_radius_m > 0 &&
         !(glm::length(position_m) <= reach * device.workspace_radius_m);
}

Status check_workspace(const DeviceCapabilities& device, const Pose& device_from_handle) {
  const glm::dvec3& position_m = device_from_handle.position_m;
  if (!outside_workspace(device, position_m, InputLimits{}.workspace_reach)) return {};
  char text[160];
  std::snprintf(text, sizeof text,
                "reports a handle %.4g m from its origin, in a workspace of %.4g m around it",
                glm::length(position_m), device.workspace_radius_m);
  return Error{ErrorCode::kDeviceRefused, "", device.name, text,
               "does its driver give millimeters? Poses are in meters"};
}

DeviceInput::DeviceInput(devices::Device& device, const DevicePlacement& placement,
                         const InputLimits& limits)
    : device_(device), placement_(placement), limits_(limits) {
  const double rate_hz = device.capabilities().rate_hz;
  if (rate_hz > 0) limits_.stale_s = std::max(limits_.stale_s, kLeastPeriods / rate_hz);
}

InputTrouble DeviceInput::trouble(const DeviceSample& sample, double dt_s) noexcept {
  const DeviceCapabilities& device = device_.capabilities();
  const Pose& pose = sample.device_from_handle;
  if (!sample.present) return InputTrouble::kDeviceLost;
  if (!sample.calibrated) return InputTrouble::kNotCalibrated;
  if (age_s_ > limits_.stale_s) return InputTrouble::kFrozen;
  if (!is_pose(pose) || (device.senses_velocity && !model::is_finite(sample.velocity))) {
    return InputTrouble::kNotFinite;
  }
  if (outside_workspace(device, pose.position_m, limits_.workspace_reach)) {
    return InputTrouble::kImplausible;
  }
  const double reach_m = kLeastJumpM + limits_.max_jump_mps * (since_good_s_ + dt_s);
  const bool jumped =
      device.hardware && has_good_ && glm::length(pose.position_m - last_good_m_) > reach_m;
  return jumped ? InputTrouble::kImplausible : InputTrouble::kNone;
}

// Between the readings of a slow device the last velocity holds.
Twist DeviceInput::velocity(const DeviceSample& sample, double dt_s) noexcept {
  if (device_.capabilities().senses_velocity) return sample.velocity;
  since_fresh_s_ += dt_s;
  if (sample.fresh) {
    estimate_ = velocity_.update(sample.device_from_handle, since_fresh_s_);
    since_fresh_s_ = 0;
  }
  return estimate_;
}

bool DeviceInput::next(double time_s, double dt_s, StepInput& input) noexcept {
  DeviceSample sample = device_.read(time_s);
  age_s_ = sample.fresh ? 0 : age_s_ + dt_s;
  health_ = {};
  health_.trouble = trouble(sample, dt_s);
  health_.age_share = static_cast<float>(std::min(1.0, age_s_ / limits_.stale_s));
  health_.output_held = sample.output_held;
  if (health_.trouble == InputTrouble::kNone) {
    sample.device_from_handle = made_unit(sample.device_from_handle);
  }
  input.world_from_handle = placement_.world_from_handle(sample.device_from_handle);
  input.buttons = sample.buttons;
  input.valid = kInputValid;
  if (health_.trouble != InputTrouble::kNone) {
    input.valid = kInputInvalid;
    input.handle_velocity = {};
    velocity_.reset();
    estimate_ = {};
    since_fresh_s_ = 0;
    // A device that comes back may do so anywhere. One that only sent nonsense may not jump.
    has_good_ = has_good_ && health_.trouble != InputTrouble::kDeviceLost &&
                health_.trouble != InputTrouble::kNotCalibrated;
    since_good_s_ += dt_s;
    return true;
  }
  has_good_ = true;
  last_good_m_ = sample.device_from_handle.position_m;
  since_good_s_ = age_s_;
  input.handle_velocity = placement_.world_twist(velocity(sample, dt_s));
  return true;
}

}  // namespace forcelayer::loop

#include "runtime/loop/input_source.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"
#include "runtime/model/vectors.h"

namespace forcelayer::loop {
namespace {

constexpr double kUnitTolerance = 1e-3;  // of a quaternion's length; a device's floats err by 1e-7
constexpr double kMinJumpM = 0.001;      // noise and quantization of the coarsest device
constexpr double kMinTurnRad = 0.01;     // the same of its rotation

// As a recording keeps it, so that a replay trips in the same frame. A sum that went back is that
// of a new connection.
float recordable_fall(double fall) {
  if (!(fall > 0)) return 0;
  return static_cast<float>(std::ceil(std::min(fall, 1.0) * kFallSteps) / kFallSteps);
}

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
  std::snprintf(
      text, sizeof text,
      "reports a handle position %.4g m from the origin, but its workspace radius is %.4g m",
      glm::length(position_m), device.workspace_radius_m);
  return Error{ErrorCode::kDeviceRefused, "", device.name, text,
               "check whether the driver gives millimeters; poses must be in meters"};
}

DeviceInput::DeviceInput(devices::Device& device, const DevicePlacement& placement,
                         const InputLimits& limits)
    : device_(device), placement_(placement), limits_(limits) {
  const double rate_hz = device.capabilities().rate_hz;
  if (rate_hz > 0) {
    const double periods_s = std::min(kStalePeriods / rate_hz, kStaleCeilingS);
    limits_.stale_s = std::max(limits_.stale_s, periods_s);
  }
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
  const bool cannot_be = device.hardware && (jumped(pose, dt_s) || claims_too_much(sample));
  return cannot_be ? InputTrouble::kImplausible : InputTrouble::kNone;
}

bool DeviceInput::jumped(const Pose& device_from_handle, double dt_s) const noexcept {
  if (!has_good_) return false;
  const double since_s = since_good_s_ + dt_s;
  const double moved_m = glm::length(device_from_handle.position_m - last_good_.position_m);
  const double turned_rad = glm::length(coupling::rotation_vector(
      made_unit(device_from_handle).orientation * glm::conjugate(last_good_.orientation)));
  return moved_m > kMinJumpM + limits_.max_jump_mps * since_s ||
         turned_rad > kMinTurnRad + limits_.max_turn_radps * since_s;
}

bool DeviceInput::claims_too_much(const DeviceSample& sample) noexcept {
  if (!device_.capabilities().senses_velocity || !sample.fresh) return false;
  unshown_ = !check_.knows();
  const bool believed =
      check_.believes(made_unit(sample.device_from_handle), sample.velocity, since_checked_s_);
  since_checked_s_ = 0;
  return !believed;
}

// Between the readings of a slow device the last velocity holds.
Twist DeviceInput::velocity(const DeviceSample& sample) noexcept {
  if (!sample.fresh) return estimate_;
  estimate_ = device_.capabilities().senses_velocity
                  ? (unshown_ ? Twist{} : sample.velocity)
                  : velocity_.update(sample.device_from_handle, since_fresh_s_);
  since_fresh_s_ = 0;
  return estimate_;
}

// Clears all that comes from earlier readings, once one is refused.
void DeviceInput::forget() noexcept {
  velocity_.reset();
  estimate_ = {};
  since_fresh_s_ = 0;
  // A device that comes back may do so anywhere. One that only sent nonsense may not jump.
  if (health_.trouble != InputTrouble::kDeviceLost &&
      health_.trouble != InputTrouble::kNotCalibrated) {
    return;
  }
  has_good_ = false;
  check_.reset();
}

bool DeviceInput::next(double time_s, double dt_s, StepInput& input) noexcept {
  DeviceSample sample = device_.read(time_s);
  age_s_ = sample.fresh ? 0 : age_s_ + dt_s;
  since_checked_s_ += dt_s;
  since_fresh_s_ += dt_s;
  health_ = {};
  health_.trouble = trouble(sample, dt_s);
  health_.age_fraction = static_cast<float>(std::min(1.0, age_s_ / limits_.stale_s));
  health_.output_held = sample.output_held;
  health_.output_fall = recordable_fall(sample.output_falls - output_falls_);
  output_falls_ = sample.output_falls;
  if (health_.trouble == InputTrouble::kNone) {
    sample.device_from_handle = made_unit(sample.device_from_handle);
  }
  input.world_from_handle = placement_.world_from_handle(sample.device_from_handle);
  input.buttons = sample.buttons;
  input.valid = kInputValid;
  if (health_.trouble != InputTrouble::kNone) {
    input.valid = kInputInvalid;
    input.handle_velocity = {};
    forget();
    since_good_s_ += dt_s;
    return true;
  }
  has_good_ = true;
  last_good_ = sample.device_from_handle;
  since_good_s_ = age_s_;
  input.handle_velocity = placement_.world_twist(velocity(sample));
  return true;
}

}  // namespace forcelayer::loop

#include "runtime/voxrun/device_choice.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "runtime/devices/hid/hid_device.h"
#include "runtime/devices/plugin/plugin_device.h"
#include "runtime/devices/sim_device.h"
#include "runtime/loop/input_source.h"
#include "runtime/machine/real_time.h"

namespace forcelayer::voxrun {
namespace {

constexpr long long kReadingNs = 3'000'000'000;
constexpr double kMinLoopPeriods = 2.5;  // of a slow loop, that its wrench may be old
constexpr double kMaxWatchdogS = 0.1;
constexpr long long kPollNs = 1'000'000;

// The pose in which the hand of a run without --motion holds still: the part's start.
Pose resting_handle(const Options& options) {
  const PartStart& start = options.start;
  if (!start.world_from_part) return options.run.placement.world_from_device;
  return *start.world_from_part * inverse(start.handle_from_part.value_or(Pose{}));
}

// From rest to rest along `shift_m`, with the least jerk.
devices::MotionScript pulled(const Pose& from, const glm::dvec3& shift_m) {
  constexpr double kRestS = 0.3, kEndS = 0.2, kMinS = 2, kMeanMps = 0.05, kRowsPerS = 100;
  const double move_s = std::max(kMinS, glm::length(shift_m) / kMeanMps);
  std::vector<devices::MotionScript::Row> rows = {{0, from}};
  const auto count = static_cast<int>(std::ceil(move_s * kRowsPerS));
  for (int n = 0; n <= count; ++n) {
    const double t = static_cast<double>(n) / count;
    const double fraction = t * t * t * (10 - 15 * t + 6 * t * t);
    rows.push_back({kRestS + t * move_s, {from.position_m + fraction * shift_m, from.orientation}});
  }
  rows.push_back({kRestS + move_s + kEndS, rows.back().world_from_handle});
  return devices::MotionScript(std::move(rows));
}

Result<ChosenDevice> make_sim(const Options& options) {
  const DevicePlacement& placement = options.run.placement;
  ChosenDevice chosen;
  devices::MotionScript script = devices::MotionScript::still(resting_handle(options));
  if (!options.motion.empty()) {
    auto read = devices::MotionScript::read(options.motion);
    if (!read) return read.error();
    script = std::move(*read);
    chosen.motion = script;
  }
  if (options.pull_m) {
    script = pulled(resting_handle(options), *options.pull_m);
    chosen.motion = script;
  }
  if (options.hand.empty()) {
    chosen.device = std::make_unique<devices::SimDevice>(std::move(script), placement);
  } else {
    chosen.device = std::make_unique<devices::SimHandDevice>(
        std::move(script), placement,
        options.hand == "loose" ? devices::loose_grip() : devices::SimHandParameters());
  }
  return chosen;
}

// Age at which the device's side drops a wrench: periods of the loop, where it is slow.
double watch_s(const Options& options) {
  return std::max(options.run.stale_s, kMinLoopPeriods / options.run.rate_hz);
}

// The device's side takes the motors to zero between the frames of a slower loop.
Status check_rate(const Options& options) {
  if (watch_s(options) <= kStaleCeilingS) return {};
  return Error{ErrorCode::kUsage, "", "--set rate_hz", "is too slow for a device with motors",
               "use 50 Hz or more"};
}

Result<ChosenDevice> make_device(const Options& options, const std::atomic<int>& stop) {
  if (options.device != "sim") {
    if (Status fast = check_rate(options); !fast) return fast.error();
  }
  if (options.device == "plugin") {
    ChosenDevice chosen;
    devices::PluginOptions plugin;
    plugin.library = options.plugin;
    plugin.arguments = options.plugin_args;
    plugin.trusted = options.trust_plugin;
    plugin.stale_s = watch_s(options);
    plugin.stop = &stop;
    chosen.device = std::make_unique<devices::PluginDevice>(plugin);
    return chosen;
  }
  if (options.device == "hid") {
    ChosenDevice chosen;
    chosen.device = std::make_unique<devices::HidDevice>(devices::make_hid_bus(), options.hid,
                                                         watch_s(options));
    return chosen;
  }
  if (options.device == "spacemouse") {
    ChosenDevice chosen;
    chosen.device = std::make_unique<devices::SpaceMouse>(devices::make_hid_bus(), options.hid,
                                                          options.spacemouse);
    return chosen;
  }
  return make_sim(options);
}

Status check_watchdog(const Options& options, const DeviceCapabilities& device) {
  const bool safe =
      device.actuated_axes == 0 || (device.watchdog_s > 0 && device.watchdog_s <= kMaxWatchdogS);
  if (safe || options.without_watchdog) return {};
  return Error{ErrorCode::kDeviceRefused, "", device.name,
               "has motors, but its watchdog is missing or above 100 ms: if the driver fails, the "
               "last force stays",
               "add without-watchdog to --device if somebody is ready to switch the device off"};
}

// A reading that a run can begin with.
bool is_usable(const DeviceSample& sample) {
  return sample.present && sample.fresh && sample.calibrated &&
         loop::is_pose(sample.device_from_handle);
}

// Why no reading came that could be used: after the last one, where any was `fresh` before.
Error no_usable_reading(const devices::Device& device, const DeviceSample& last, bool fresh) {
  const std::string& name = device.capabilities().name;
  if (last.present && !last.calibrated) {
    return {ErrorCode::kDeviceRefused, "", name, "is not calibrated",
            "calibrate it and start again"};
  }
  if (last.present && fresh) {
    return {ErrorCode::kDeviceRefused, "", name,
            "reports no pose: its numbers are not finite, or its quaternion is not of length 1",
            "check the device's driver"};
  }
  const devices::DeviceTrouble trouble = device.trouble();
  return {ErrorCode::kDeviceFailed, "", name,
          "gives no readings" + (trouble.what.empty() ? "" : " (" + trouble.what + ")"),
          trouble.mend.empty() ? "check plug and power" : trouble.mend};
}

}  // namespace

Result<ChosenDevice> choose_device(const Options& options, const std::atomic<int>& stop) {
  auto chosen = make_device(options, stop);
  if (!chosen) return chosen.error();
  if (Status started = chosen->device->start(); !started) return started.error();
  if (Status safe = check_watchdog(options, chosen->device->capabilities()); !safe) {
    chosen->device->stop();
    return safe.error();
  }
  return chosen;
}

Result<Pose> wait_for_pose(devices::Device& device, const std::atomic<int>& stop) {
  const long long begin_ns = machine::monotonic_ns();
  DeviceSample sample = device.read(0);
  bool fresh = sample.fresh;
  while (!is_usable(sample)) {
    if (stop != 0 || machine::monotonic_ns() - begin_ns > kReadingNs)
      return no_usable_reading(device, sample, fresh);
    machine::sleep_until_ns(machine::monotonic_ns() + kPollNs);
    sample = device.read(0);
    fresh |= sample.fresh;
  }
  const Pose& pose = sample.device_from_handle;
  if (Status inside = loop::check_workspace(device.capabilities(), pose); !inside)
    return inside.error();
  return loop::made_unit(pose);
}

}  // namespace forcelayer::voxrun

// The device that the command line names.
#pragma once

#include <memory>
#include <optional>

#include "formats/result.h"
#include "runtime/devices/device.h"
#include "runtime/placement.h"
#include "runtime/voxrun/options.h"

namespace forcelayer::voxrun {

struct ChosenDevice {
  std::unique_ptr<Device> device;      // started
  std::optional<double> motion_end_s;  // of a scripted hand
};

// Makes and starts it. Errors: kUsage, of files, of devices; kDeviceRefused for a device with
// motors and no watchdog, unless the options allow it.
Result<ChosenDevice> choose_device(const Options& options, const DevicePlacement& placement);

// Where the device has the handle, its rotation made unit; nothing where it has no fresh reading
// that a run can begin with.
std::optional<Pose> usable_pose(Device& device);

// Waits for one. Errors: kDeviceFailed where none comes, kDeviceRefused where it is not calibrated
// or its pose cannot be in metres.
Result<Pose> first_pose(Device& device);

}  // namespace forcelayer::voxrun

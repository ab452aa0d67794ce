// The device that the command line names.
#pragma once

#include <atomic>
#include <memory>
#include <optional>

#include "formats/result.h"
#include "runtime/devices/device.h"
#include "runtime/devices/motion_script.h"
#include "runtime/voxrun/options.h"

namespace forcelayer::voxrun {

struct ChosenDevice {
  std::unique_ptr<devices::Device> device;      // started
  std::optional<devices::MotionScript> motion;  // of a scripted hand
};

// Makes and starts it. Errors: kUsage, of files, of devices; kDeviceRefused for a device with
// motors and no watchdog, unless the options allow it. Once `stop` is not 0, neither this nor
// wait_for_pose() waits any longer, and the error says so.
Result<ChosenDevice> choose_device(const Options& options, const std::atomic<int>& stop);

// Waits for a reading that a run can begin with: where the device has the handle, its rotation made
// unit. Errors: kDeviceFailed where none comes, kDeviceRefused where it is not calibrated or its
// pose is invalid, or cannot be in meters.
Result<Pose> wait_for_pose(devices::Device& device, const std::atomic<int>& stop);

}  // namespace forcelayer::voxrun

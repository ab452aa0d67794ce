// --device KIND[:NAME=VALUE,...] and --buttons of voxrun.
#pragma once

#include "runtime/voxrun/options.h"

namespace forcelayer::voxrun {

// Declares --device and --buttons, and the table of the names that follow a kind of device.
void add_device_options(CLI::App& app, DeviceTexts& texts);

// Errors: kUsage for an unknown kind, and for names and values that the kind does not have.
Status read_device(const DeviceTexts& texts, Options& options);

}  // namespace forcelayer::voxrun

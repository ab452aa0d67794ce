// --device KIND[:NAME=VALUE,...] of voxrun.
#pragma once

#include "runtime/voxrun/options.h"

namespace forcelayer::voxrun {

// Declares --device and the table of the names that follow a kind of device.
void add_device_options(CLI::App& app, std::string& text);

// Errors: kUsage for an unknown kind, and for names and values that the kind does not have.
Status read_device(const std::string& text, Options& options);

}  // namespace forcelayer::voxrun

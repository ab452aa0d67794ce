// --set NAME=VALUE of voxrun: the physical parameters of a run, and the limits of its loop.
#pragma once

#include <string>

#include "runtime/voxrun/options.h"

namespace forcelayer::voxrun {

// Declares --set and its table in the help. `texts`: what was typed, separated by commas.
void add_settings(CLI::App& app, std::string& texts);

// Errors: kUsage for a name that is not known, or a number out of its range.
Status read_settings(const std::string& texts, Options& options);

}  // namespace forcelayer::voxrun

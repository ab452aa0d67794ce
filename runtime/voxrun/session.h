// A run of voxrun, from the files to the report.
#pragma once

#include <atomic>

#include "formats/result.h"
#include "runtime/voxrun/options.h"

namespace forcelayer::voxrun {

// Runs until the duration, the motion or the recording ends, or `stop` is not 0 (then everything is
// written all the same). `next_scene`, set to 1 from outside, asks for the next scene. `began` is
// set to false where `stop` came while the device was waited for: there was no frame, and nothing
// is written. Errors: of files, usage, device.
Status run_session(const Options& options, std::atomic<int>& stop, std::atomic<int>& next_scene,
                   bool& began);

}  // namespace forcelayer::voxrun

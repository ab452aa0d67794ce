// A run as rows, from the trace of it or from its recording.
#pragma once

#include <filesystem>
#include <vector>

#include "formats/result.h"
#include "runtime/viewer/run/trace.h"

namespace forcelayer {

// Reads a trace CSV, or a recording (told by its magic), which is played again with `voxmap` and
// `shell`: the files that it was made with, else kFilesDoNotMatch; kUsage where they are not given.
Result<std::vector<TraceRow>> read_run(const std::filesystem::path& path,
                                       const std::filesystem::path& voxmap,
                                       const std::filesystem::path& shell);

}  // namespace forcelayer

// A run as rows: from its trace, from its recording, from a path alone, or from its pose stream
// while it goes on.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "forcelayer/pose_receiver.h"
#include "formats/result.h"
#include "workbench/viewer/run/trace.h"

namespace forcelayer::viewer {

// Reads a trace CSV, a path of the part (without forces; about the centroid of `shell`, where that
// is given), or a recording. A recording is known by its magic, and played again with `voxmap` and
// `shell`: the files that it was made with, else kFilesDoNotMatch; kUsage where they are not given.
Result<std::vector<TraceRow>> read_run(const std::filesystem::path& path,
                                       const std::filesystem::path& voxmap,
                                       const std::filesystem::path& shell);

// Listens for a pose stream at "PORT" or "ADDRESS:PORT". Errors: kUsage, kReadFailed.
Result<PoseReceiver> listen_at(const std::string& text);

// A datagram of the stream as a row.
TraceRow row_of(const PoseDatagram& datagram);

}  // namespace forcelayer::viewer

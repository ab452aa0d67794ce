// The path that is checked, whatever kind of file it is in.
#pragma once

#include <string>
#include <vector>

#include "formats/path/path_file.h"
#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"

namespace forcelayer::voxcheck {

// The poses of the part: of a CSV or a trace as they are there. Errors: those of read_path().
Result<std::vector<PathRow>> read_part_path(const std::string& path);

}  // namespace forcelayer::voxcheck

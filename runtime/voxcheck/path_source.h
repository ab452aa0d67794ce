// Reads the path that is checked, from any kind of file.
#pragma once

#include <string>
#include <vector>

#include "formats/path/path_file.h"
#include "formats/result.h"

namespace forcelayer::voxcheck {

// The poses of the part. A CSV or a trace has them. A recording is replayed with the files that it
// was made with: `scene` and `part` are the paths of these. Errors: those of read_path() and of
// stream::recorded_simulation().
Result<std::vector<PathRow>> read_part_path(const std::string& path, const std::string& scene,
                                            const std::string& part);

}  // namespace forcelayer::voxcheck

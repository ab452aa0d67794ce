// The path that is checked, whatever kind of file it is in.
#pragma once

#include <string>
#include <vector>

#include "formats/path/path_file.h"
#include "formats/result.h"

namespace forcelayer::voxcheck {

// The poses of the part: of a CSV or a trace as they are there; of a recording as it comes out
// again with the files that it was made with. `scene` and `part` are their paths. Errors: those of
// read_path() and of stream::recorded_simulation().
Result<std::vector<PathRow>> read_part_path(const std::string& path, const std::string& scene,
                                            const std::string& part);

}  // namespace forcelayer::voxcheck

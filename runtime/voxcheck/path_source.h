// Reads the path that is checked, from any kind of file.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "formats/path/path_file.h"
#include "formats/pshell.h"
#include "formats/result.h"

namespace forcelayer::voxcheck {

struct PathSource {
  std::string scene, part, path;  // files, as given
  // The point of the part (part frame, m) that moves straight between two poses of a CSV; none: the
  // centroid.
  std::optional<std::array<double, 3>> pivot_m;
};

// The poses of the part, between which its centroid moves straight. A CSV or a trace has them. A
// recording is replayed with the files that it was made with. With a pivot, poses are added: no
// point of the part is off by more than kPivotM. Errors: those of read_path(), of turned_about()
// and of stream::recorded_simulation().
Result<std::vector<PathRow>> read_part_path(const PathSource& source, const Pshell& part);

inline constexpr double kPivotM = 1e-7;  // as closely as least distances are printed

}  // namespace forcelayer::voxcheck

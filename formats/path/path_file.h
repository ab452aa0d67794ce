// Paths as files: poses over time in CSV. docs/paths.md describes the columns.
#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "formats/file/atomic_file.h"
#include "formats/result.h"

namespace forcelayer {

// A pose at a time: world_from_part or world_from_handle. The quaternion is of length 1.
struct PathRow {
  double time_s = 0;
  std::array<double, 3> position_m{0, 0, 0};
  std::array<double, 4> orientation_wxyz{1, 0, 0, 0};
};

// Limits of a path. Distances and times between its rows are finite by far.
inline constexpr double kFarthestPathM = 1e9;  // of a position from the origin, along an axis
inline constexpr double kLatestPathS = 1e12;   // of a time from 0
inline constexpr std::size_t kMaxPathRows = 100'000'000;  // 28 hours at 1 kHz

// The poses to read from a trace, which has `part_` and `handle_` columns.
enum class PathOf { kPart, kHandle };

// Reads a path: at least one row, times ascending, within the limits, quaternions normalized.
// Errors: kFileNotFound, kReadFailed, and kUsage with the line for anything that is no path.
Result<std::vector<PathRow>> read_path(const std::filesystem::path& path, PathOf of);

// Writes a path, row by row. The file appears with finish(); without it nothing is left behind.
// Nothing is written that read_path refuses (no row, times that do not ascend, numbers that are
// none or beyond the limits): kInternal.
class PathWriter {
 public:
  static Result<PathWriter> create(const std::filesystem::path& path);

  Status add(const PathRow& row);
  Status finish();

 private:
  explicit PathWriter(AtomicFile file) : file_(std::move(file)) {}
  Status flush();

  AtomicFile file_;
  std::string text_;
  double last_s_ = -std::numeric_limits<double>::infinity();
};

}  // namespace forcelayer

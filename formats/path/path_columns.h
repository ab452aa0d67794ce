// The header line of a path: which column holds what, in which unit.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/path/path_file.h"

namespace forcelayer {

// The columns of one file.
struct PathColumns {
  enum class Turn { kNone, kQuaternion, kAngles };
  static constexpr std::size_t kValues = 8;  // time, x, y, z, and up to four of the orientation

  char separator = ',';
  std::size_t cells = 0;                 // in a line
  std::vector<std::int8_t> value_of;     // per cell the value that it holds, or -1
  std::array<double, kValues> factor{};  // of each value: to seconds, meters, radians
  Turn turn = Turn::kNone;
  std::size_t values = 4;  // that a line must have
};

// Reads a header line into `columns`. Returns the mistake where the line has one.
std::optional<std::string> read_path_header(std::string_view line, PathOf of, PathColumns& columns);

// The pose of a line's values, which are in SI units. Nothing where a quaternion has no direction.
std::optional<PathRow> path_row(const PathColumns& columns,
                                const std::array<double, PathColumns::kValues>& values);

}  // namespace forcelayer

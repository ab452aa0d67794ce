// The lines of a path: which column of the header holds what, in which unit, and the pose of a row.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "formats/path/path_file.h"

namespace forcelayer {

// The columns of one file.
struct PathColumns {
  static constexpr std::size_t kValues = 11;  // t, x, y, z, qw, qx, qy, qz, rx, ry, rz
  static constexpr char kOther = kValues;
  using Values = std::array<double, kValues>;

  char separator = ',';
  std::string header;
  std::string value_of;  // [cells in a line] a byte each: the number of its value, or kOther
  Values factor{};       // of each value: to seconds, meters, radians
};

// Takes the first cell off a line: up to the separator, but for one in quotes; without the quotes,
// and blanks about it. Behind the last cell the line's data() is null.
std::string_view take_cell(std::string_view& line, char separator);

// 'text', escaped, and shortened where it is long.
std::string in_quotes(std::string_view text);

// The name of the column that holds a value, as the header has it, in quotes.
std::string name_of(const PathColumns& columns, std::size_t value);

// Reads a header line into `columns`, which are empty. Returns the mistake where it has one, else
// an empty text. A column that may be a turn, and would not be read, is one.
std::string read_path_header(std::string_view line, PathOf of, PathColumns& columns);

// The pose of a line whose values are in SI units, those that it has not 0. Nothing where the
// quaternion is zero.
std::optional<PathRow> path_row(const PathColumns& columns, const PathColumns::Values& values);

// The value of a turn that has half a turn or more between two rows, so that the short way round
// may not be the one that is meant; nothing where there is none, and where it starts anew within
// one turn and the poses are a quarter turn apart at most.
std::optional<std::size_t> open_turn(const PathColumns::Values& a, const PathColumns::Values& b,
                                     const PathRow& from, const PathRow& to);

}  // namespace forcelayer

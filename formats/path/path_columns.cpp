#include "formats/path/path_columns.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "formats/path/quaternion.h"

namespace forcelayer {
namespace {

struct Unit {
  std::string_view name;
  double factor;
};

constexpr double kRadPerDeg = 0.017453292519943295;
constexpr Unit kTimes[] = {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}};
constexpr Unit kLengths[] = {{"m", 1},     {"mm", 1e-3},   {"cm", 1e-2},
                             {"um", 1e-6}, {"in", 0.0254}, {"ft", 0.3048}};
constexpr Unit kAngles[] = {{"rad", 1}, {"deg", kRadPerDeg}};
constexpr Unit kNoUnit[] = {{"", 1}};

std::string_view trimmed(std::string_view text) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '"'; };
  while (!text.empty() && blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && blank(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string> split(std::string_view line, char separator) {
  std::vector<std::string> names;
  while (true) {
    const std::size_t end = line.find(separator);
    std::string name(trimmed(line.substr(0, end)));
    for (char& c : name) {
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    }
    names.push_back(std::move(name));
    if (end == std::string_view::npos) return names;
    line.remove_prefix(end + 1);
  }
}

// A search for columns among the names of a header.
struct Search {
  const std::vector<std::string>& names;
  PathColumns& columns;

  // Gives `value` the column "STEM_UNIT", or "STEM" where the only unit is none.
  bool take(std::size_t value, std::string_view stem, std::span<const Unit> units) const {
    for (const Unit& unit : units) {
      std::string wanted(stem);
      if (!unit.name.empty()) (wanted += '_') += unit.name;
      const auto at = std::find(names.begin(), names.end(), wanted);
      if (at == names.end()) continue;
      columns.value_of[static_cast<std::size_t>(at - names.begin())] =
          static_cast<std::int8_t>(value);
      columns.factor[value] = unit.factor;
      return true;
    }
    return false;
  }

  bool has_stem(const std::string& stem) const {
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& name) { return name.starts_with(stem); });
  }
};

std::string missing(const std::string& stem, const char* examples) {
  return "has no column " + stem + examples;
}

// The prefix of the poses that are wanted: that of a trace where the file has them.
std::string prefix_of(PathOf of, const Search& search) {
  const std::string wanted = of == PathOf::kPart ? "part_" : "handle_";
  return search.has_stem(wanted + "x_") ? wanted : std::string();
}

std::optional<std::string> find_orientation(const std::string& prefix, const Search& search) {
  constexpr const char* kQuaternion[] = {"qw", "qx", "qy", "qz"};
  constexpr const char* kAxes[] = {"rx", "ry", "rz"};
  std::size_t found = 0;
  std::string absent;
  for (std::size_t n = 0; n < 4; ++n) {
    if (search.take(4 + n, prefix + kQuaternion[n], kNoUnit)) {
      ++found;
    } else if (absent.empty()) {
      absent = prefix + kQuaternion[n];
    }
  }
  if (found == 4) {
    search.columns.turn = PathColumns::Turn::kQuaternion;
    search.columns.values = 8;
    return std::nullopt;
  }
  if (found > 0) return missing(absent, ": a quaternion has the columns qw, qx, qy and qz");
  absent.clear();
  for (std::size_t n = 0; n < 3; ++n) {
    if (search.take(4 + n, prefix + kAxes[n], kAngles)) {
      ++found;
    } else if (absent.empty()) {
      absent = prefix + kAxes[n];
    }
  }
  if (found == 0) return std::nullopt;
  if (found < 3) return missing(absent + "_deg", ": turns have the columns rx, ry and rz");
  search.columns.turn = PathColumns::Turn::kAngles;
  search.columns.values = 7;
  return std::nullopt;
}

// Turns about the world's axes: x first, then y, then z.
Quaternion turned(double about_x_rad, double about_y_rad, double about_z_rad) {
  const auto about = [](std::size_t axis, double angle_rad) {
    Quaternion q{std::cos(angle_rad / 2), 0, 0, 0};
    q[axis + 1] = std::sin(angle_rad / 2);
    return q;
  };
  return product(about(2, about_z_rad), product(about(1, about_y_rad), about(0, about_x_rad)));
}

}  // namespace

std::optional<std::string> read_path_header(std::string_view line, PathOf of,
                                            PathColumns& columns) {
  columns = {};
  if (line.find(';') != std::string_view::npos) {
    columns.separator = ';';
  } else if (line.find('\t') != std::string_view::npos) {
    columns.separator = '\t';
  }
  const std::vector<std::string> names = split(line, columns.separator);
  columns.cells = names.size();
  columns.value_of.assign(names.size(), -1);
  const Search search{names, columns};
  if (!search.take(0, "t", kTimes) && !search.take(0, "time", kTimes)) {
    return missing("t_s", " (or t_ms)");
  }
  const std::string prefix = prefix_of(of, search);
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string stem = prefix + kAxes[axis];
    if (!search.take(1 + axis, stem, kLengths)) {
      return missing(stem + "_m", (" (or " + stem + "_mm): a column names its unit").c_str());
    }
  }
  return find_orientation(prefix, search);
}

std::optional<PathRow> path_row(const PathColumns& columns,
                                const std::array<double, PathColumns::kValues>& v) {
  PathRow row{v[0], {v[1], v[2], v[3]}, {1, 0, 0, 0}};
  if (columns.turn == PathColumns::Turn::kNone) return row;
  Quaternion q = columns.turn == PathColumns::Turn::kQuaternion ? Quaternion{v[4], v[5], v[6], v[7]}
                                                                : turned(v[4], v[5], v[6]);
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(length > 1e-6) || !std::isfinite(length)) return std::nullopt;
  for (double& part : q) part /= length;
  row.orientation_wxyz = q;
  return row;
}

}  // namespace forcelayer

#include "formats/voxinfo/sample.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace forcelayer::voxinfo {
namespace {

constexpr std::string_view kSpace = " \t\r,";

// Exactly three finite numbers.
std::optional<std::array<double, 3>> parse_point_line(std::string_view line) {
  std::array<double, 3> point{};
  for (double& coordinate : point) {
    line.remove_prefix(std::min(line.find_first_not_of(kSpace), line.size()));
    if (line.starts_with('+')) line.remove_prefix(1);
    const auto [end, failure] = std::from_chars(line.data(), line.data() + line.size(), coordinate);
    if (failure != std::errc{} || !std::isfinite(coordinate)) return std::nullopt;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    if (!line.empty() && kSpace.find(line.front()) == std::string_view::npos) return std::nullopt;
  }
  if (line.find_first_not_of(kSpace) != std::string_view::npos) return std::nullopt;
  return point;
}

// World voxel of a point; coordinates beyond 2^53 voxels stay beyond every map.
std::array<std::int64_t, 3> voxel_of(const std::array<double, 3>& point_m, double voxel_size_m) {
  constexpr double kFar = 0x1p53;
  std::array<std::int64_t, 3> voxel{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double index = std::floor(point_m[axis] / voxel_size_m);
    voxel[axis] = static_cast<std::int64_t>(std::clamp(index, -kFar, kFar));
  }
  return voxel;
}

bool is_beyond_cropped_side(const VoxmapHeader& h, const std::array<std::int64_t, 3>& voxel) {
  const KnownBox known = known_box(h);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (voxel[axis] < known.low[axis] || voxel[axis] >= known.high[axis]) return true;
  }
  return false;
}

// Where nothing is known, or by the highest code, a bound is infinite.
void write_distance(std::ostream& lines, double meters) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, meters).ptr;
  lines << '\t' << std::string_view(text, static_cast<std::size_t>(end - text));
}

// The name; behind that of an object that may not be the nearest one, another column says so.
void write_object(std::ostream& lines, const Voxmap& map,
                  const std::array<std::int64_t, 3>& voxel) {
  const auto [i, j, k] = voxel;
  const std::uint32_t object = map.nearest_object(i, j, k);
  lines << escaped(map.object_name(object));
  const bool measured =
      std::isfinite(map.min_distance_m(i, j, k)) && std::isfinite(map.max_distance_m(i, j, k));
  if (object != 0 && !measured) lines << "\thint";
}

void write_line(std::ostream& lines, const Voxmap& map, const std::array<std::int64_t, 3>& voxel,
                bool known) {
  const auto [i, j, k] = voxel;
  lines << static_cast<int>(map.value(i, j, k));
  if (map.distances() != nullptr) {
    constexpr double kUnknown = std::numeric_limits<double>::infinity();
    write_distance(lines, known ? map.min_distance_m(i, j, k) : -kUnknown);
    write_distance(lines, known ? map.max_distance_m(i, j, k) : kUnknown);
  }
  if (map.objects() != nullptr) {
    lines << '\t';
    if (known) write_object(lines, map, voxel);
  }
  lines << '\n';
}

}  // namespace

Status sample_voxmap(const Voxmap& map, std::istream& points, std::ostream& lines,
                     std::uint64_t& outside_points) {
  outside_points = 0;
  std::string line;
  for (std::uint64_t number = 1; std::getline(points, line); ++number) {
    if (line.find_first_not_of(kSpace) == std::string::npos) continue;
    const auto point = parse_point_line(line);
    if (!point) {
      return Error{ErrorCode::kUsage, "", "input line " + std::to_string(number),
                   "'" + line.substr(0, 60) + "' is not three finite numbers",
                   "write x y z in meters"};
    }
    const auto voxel = voxel_of(*point, map.voxel_size_m());
    const bool known = !is_beyond_cropped_side(map.header(), voxel);
    outside_points += !known;
    write_line(lines, map, voxel, known);
  }
  return {};
}

}  // namespace forcelayer::voxinfo

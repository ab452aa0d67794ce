#include "runtime/devices/motion_script.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <string>
#include <string_view>
#include <system_error>

#include "runtime/coupling/coupling.h"

namespace forcelayer::devices {
namespace {

constexpr std::string_view kHeader = "t_s,x_m,y_m,z_m,qw,qx,qy,qz";
constexpr std::size_t kColumns = 8;
constexpr std::size_t kMaxLine = 4096;         // bytes
constexpr std::size_t kMaxRows = 100'000'000;  // 28 hours at 1 kHz

Error line_error(const std::filesystem::path& path, std::size_t line, std::string what) {
  return {ErrorCode::kUsage, path.string(), "line " + std::to_string(line), std::move(what),
          "a motion file has the columns " + std::string(kHeader)};
}

std::string_view without_line_end(std::string_view line) {
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  return line;
}

bool parse_columns(std::string_view line, std::array<double, kColumns>& columns) {
  for (std::size_t i = 0; i < kColumns; ++i) {
    while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
    const auto [end, failure] = std::from_chars(line.data(), line.data() + line.size(), columns[i]);
    if (failure != std::errc{} || !std::isfinite(columns[i])) return false;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()));
    while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
    if (i + 1 == kColumns) return line.empty();
    if (line.empty() || line.front() != ',') return false;
    line.remove_prefix(1);
  }
  return false;
}

Result<MotionScript::Row> parse_row(const std::filesystem::path& path, std::size_t number,
                                    std::string_view line) {
  std::array<double, kColumns> c{};
  if (!parse_columns(line, c)) {
    return line_error(path, number, "is not eight finite numbers with commas between");
  }
  const glm::dquat q(c[4], c[5], c[6], c[7]);
  const double length = glm::length(q);
  if (!(length > 1e-6) || !std::isfinite(length)) {
    return line_error(path, number, "has a quaternion without direction");
  }
  return MotionScript::Row{c[0], {{c[1], c[2], c[3]}, q / length}};
}

}  // namespace

MotionScript::MotionScript(std::vector<Row> rows) : rows_(std::move(rows)) {}

MotionScript MotionScript::still(const Pose& world_from_handle) {
  return MotionScript({{0, world_from_handle}});
}

Result<MotionScript> MotionScript::read(const std::filesystem::path& path) {
  std::error_code failure;
  if (!std::filesystem::exists(path, failure) || std::filesystem::is_directory(path, failure)) {
    return Error{ErrorCode::kFileNotFound, path.string(), "", "no such file",
                 "--motion wants a CSV file of hand poses"};
  }
  std::ifstream file(path);
  std::vector<Row> rows;
  std::array<char, kMaxLine + 1> line{};  // no more of a file without line ends is held
  std::size_t number = 0;
  while (file.getline(line.data(), line.size()) || file.gcount() > 0) {
    ++number;
    if (!file && !file.eof()) return line_error(path, number, "is longer than 4096 bytes");
    const auto length = static_cast<std::size_t>(file.gcount()) - (file.eof() ? 0 : 1);
    const std::string_view text = without_line_end({line.data(), length});
    if (number == 1) {
      if (text != kHeader) return line_error(path, number, "is not the header line");
      continue;
    }
    if (text.empty()) continue;
    auto row = parse_row(path, number, text);
    if (!row) return row.error();
    if (!rows.empty() && !(row->time_s > rows.back().time_s)) {
      return line_error(path, number, "is not later than the line before");
    }
    if (rows.size() == kMaxRows) return line_error(path, number, "is beyond 100 million rows");
    rows.push_back(*row);
  }
  if (file.bad() || (!file.eof() && number == 0)) {
    return Error{ErrorCode::kReadFailed, path.string(), "", "cannot be read", ""};
  }
  if (rows.empty()) return line_error(path, number + 1, "is missing: there are no poses");
  return MotionScript(std::move(rows));
}

std::size_t MotionScript::segment(double time_s) const noexcept {
  const auto next = std::upper_bound(rows_.begin(), rows_.end(), time_s,
                                     [](double t, const Row& row) { return t < row.time_s; });
  return next == rows_.begin() ? 0 : static_cast<std::size_t>(next - rows_.begin()) - 1;
}

Pose MotionScript::pose(double time_s) const noexcept {
  if (time_s <= rows_.front().time_s) return rows_.front().world_from_handle;
  const std::size_t at = segment(time_s);
  if (at + 1 == rows_.size()) return rows_.back().world_from_handle;
  const Row &a = rows_[at], &b = rows_[at + 1];
  const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
  const Pose &from = a.world_from_handle, &to = b.world_from_handle;
  const glm::dvec3 turn =
      coupling::rotation_vector(to.orientation * glm::conjugate(from.orientation)) * share;
  return {from.position_m + (to.position_m - from.position_m) * share,
          glm::normalize(coupling::rotation_by(turn) * from.orientation)};
}

Twist MotionScript::velocity(double time_s) const noexcept {
  if (time_s < rows_.front().time_s) return {};
  const std::size_t at = segment(time_s);
  if (at + 1 == rows_.size()) return {};
  const Row &a = rows_[at], &b = rows_[at + 1];
  const double seconds = b.time_s - a.time_s;
  const Pose &from = a.world_from_handle, &to = b.world_from_handle;
  return {(to.position_m - from.position_m) / seconds,
          coupling::rotation_vector(to.orientation * glm::conjugate(from.orientation)) / seconds};
}

}  // namespace forcelayer::devices

#include "workbench/viewer/run/trace.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <glm/geometric.hpp>
#include <string>
#include <string_view>

namespace forcelayer::viewer {
namespace {

constexpr std::array<std::string_view, 27> kColumns = {"t_s",
                                                       "handle_x_m",
                                                       "handle_y_m",
                                                       "handle_z_m",
                                                       "handle_qw",
                                                       "handle_qx",
                                                       "handle_qy",
                                                       "handle_qz",
                                                       "part_x_m",
                                                       "part_y_m",
                                                       "part_z_m",
                                                       "part_qw",
                                                       "part_qx",
                                                       "part_qy",
                                                       "part_qz",
                                                       "force_x_n",
                                                       "force_y_n",
                                                       "force_z_n",
                                                       "torque_x_nm",
                                                       "torque_y_nm",
                                                       "torque_z_nm",
                                                       "contacts",
                                                       "guard_cuts",
                                                       "step_ns",
                                                       "points_proximity",
                                                       "points_surface",
                                                       "points_interior"};

// Columns that hold counts, by their place in kColumns.
constexpr std::size_t kCounts[] = {21, 22, 24, 25, 26};

// Columns that a trace need not have. The name of an object may be quoted, and comes last.
constexpr std::string_view kClearance = "clearance_m", kAtLeast = "clearance_at_least",
                           kObject = "nearest_object";

// The comma that ends the first cell; one within quotes does not.
std::size_t cell_end(std::string_view line) {
  bool quoted = false;
  for (std::size_t n = 0; n < line.size(); ++n) {
    if (line[n] == '"') quoted = !quoted;
    if (line[n] == ',' && !quoted) return n;
  }
  return std::string_view::npos;
}

std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> cells;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  while (true) {
    const std::size_t comma = cell_end(line);
    cells.push_back(line.substr(0, comma));
    if (comma == std::string_view::npos) return cells;
    line.remove_prefix(comma + 1);
  }
}

Error bad_line(const std::filesystem::path& path, std::size_t line, const std::string& what) {
  return {ErrorCode::kFieldInvalid, path.string(), "line " + std::to_string(line), what,
          "give the CSV that voxrun --trace wrote, or a path of the part"};
}

std::string unquoted(std::string_view cell) {
  if (cell.size() < 2 || cell.front() != '"' || cell.back() != '"') return std::string(cell);
  std::string text;
  cell = cell.substr(1, cell.size() - 2);
  for (std::size_t n = 0; n < cell.size(); ++n) {
    text += cell[n];
    if (cell[n] == '"' && n + 1 < cell.size() && cell[n + 1] == '"') ++n;
  }
  return text;
}

bool read_number(std::string_view cell, double& number) {
  const auto parsed = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  return parsed.ec == std::errc{} && parsed.ptr == cell.data() + cell.size() &&
         std::isfinite(number);
}

// The clearance of a line whose columns stand at these places, where it has them and tells one.
struct ClearanceColumns {
  std::size_t clearance, at_least, object;

  explicit ClearanceColumns(std::string_view header) {
    const auto names = split(header);
    const auto place = [&](std::string_view name) {
      return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    };
    clearance = place(kClearance), at_least = place(kAtLeast), object = place(kObject);
  }

  std::optional<RowClearance> of(const std::vector<std::string_view>& cells) const {
    if (std::max({clearance, at_least, object}) >= cells.size()) return std::nullopt;
    RowClearance row;
    double at_least_number = 0;
    if (!read_number(cells[clearance], row.clearance_m)) return std::nullopt;
    if (!read_number(cells[at_least], at_least_number)) return std::nullopt;
    row.at_least = at_least_number != 0;
    row.object = unquoted(cells[object]);
    return row;
  }
};

// The place of each of kColumns in the file.
Result<std::array<std::size_t, kColumns.size()>> find_columns(const std::filesystem::path& path,
                                                              std::string_view header) {
  const auto names = split(header);
  std::array<std::size_t, kColumns.size()> places{};
  for (std::size_t n = 0; n < kColumns.size(); ++n) {
    const auto found = std::find(names.begin(), names.end(), kColumns[n]);
    if (found == names.end()) {
      return Error{ErrorCode::kNotThisFormat, path.string(), "line 1",
                   "no column '" + std::string(kColumns[n]) + "'",
                   "give the CSV that voxrun --trace wrote, or a path of the part"};
    }
    places[n] = static_cast<std::size_t>(found - names.begin());
  }
  return places;
}

Pose pose_of(const double* v) {
  return {{v[0], v[1], v[2]}, glm::normalize(glm::dquat(v[3], v[4], v[5], v[6]))};
}

bool is_count(double number) { return number >= 0 && number <= double{UINT32_MAX}; }

TraceRow row_of(const std::array<double, kColumns.size()>& v) {
  TraceRow row;
  row.time_s = v[0];
  row.world_from_handle = pose_of(&v[1]);
  row.world_from_part = pose_of(&v[8]);
  row.on_hand = Wrench{{v[15], v[16], v[17]}, {v[18], v[19], v[20]}};
  row.contacts = static_cast<std::uint32_t>(v[21]);
  row.guard_cuts = static_cast<std::uint32_t>(v[22]);
  row.step_ns = v[23];
  row.points_proximity = static_cast<std::uint32_t>(v[24]);
  row.points_surface = static_cast<std::uint32_t>(v[25]);
  row.points_interior = static_cast<std::uint32_t>(v[26]);
  return row;
}

}  // namespace

Result<std::vector<TraceRow>> read_trace(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    return Error{ErrorCode::kFileNotFound, path.string(), "", "no such file", ""};
  }
  std::ifstream file(path, std::ios::binary);
  std::string line;
  if (!std::getline(file, line)) {
    return Error{ErrorCode::kNotThisFormat, path.string(), "", "the header line is missing",
                 "give the CSV that voxrun --trace wrote, or a path of the part"};
  }
  const auto places = find_columns(path, line);
  if (!places) return places.error();
  const ClearanceColumns clearance(line);
  std::vector<TraceRow> rows;
  for (std::size_t number = 2; std::getline(file, line); ++number) {
    const auto cells = split(line);
    std::array<double, kColumns.size()> values{};
    for (std::size_t n = 0; n < kColumns.size(); ++n) {
      const std::size_t place = (*places)[n];
      if (place >= cells.size()) return bad_line(path, number, "the line has too few cells");
      const std::string_view cell = cells[place];
      if (!read_number(cell, values[n])) {
        return bad_line(path, number, "'" + std::string(cell) + "' is not a number");
      }
    }
    for (const std::size_t n : kCounts) {
      if (is_count(values[n])) continue;
      return bad_line(path, number,
                      std::string(kColumns[n]) + " is not a whole number of zero or more");
    }
    rows.push_back(row_of(values));
    rows.back().clearance = clearance.of(cells);
  }
  if (file.bad()) return Error{ErrorCode::kReadFailed, path.string(), "", "cannot be read", ""};
  if (rows.empty()) {
    return Error{ErrorCode::kNotThisFormat, path.string(), "", "no row follows the header", ""};
  }
  return rows;
}

std::size_t row_at(const std::vector<TraceRow>& rows, double time_s) {
  const auto after = std::upper_bound(rows.begin(), rows.end(), time_s,
                                      [](double t, const TraceRow& row) { return t < row.time_s; });
  return after == rows.begin() ? 0 : static_cast<std::size_t>(after - rows.begin()) - 1;
}

std::string_view NotableRows::name_of(std::size_t row) const {
  if (row == min_clearance) return "the least proven clearance";
  return row == strongest ? "the strongest force" : "";
}

NotableRows notable_rows(const std::vector<TraceRow>& rows) {
  NotableRows notable;
  const auto force_n = [](const TraceRow& row) {
    return glm::length(row.on_hand.value_or(Wrench()).force_n);
  };
  const auto stronger = [&](const TraceRow& a, const TraceRow& b) {
    if ((a.contacts > 0) != (b.contacts > 0)) return a.contacts > 0;
    return force_n(a) > force_n(b);
  };
  std::optional<std::size_t> nearest;
  std::size_t strongest = 0;
  for (std::size_t n = 0; n < rows.size(); ++n) {
    const auto& clearance = rows[n].clearance;
    if (clearance && (!nearest || clearance->clearance_m < rows[*nearest].clearance->clearance_m)) {
      nearest = n;
    }
    if (stronger(rows[n], rows[strongest])) strongest = n;
  }
  if (nearest && !rows[*nearest].clearance->at_least) notable.min_clearance = nearest;
  if (force_n(rows[strongest]) > 0) notable.strongest = strongest;
  return notable;
}

}  // namespace forcelayer::viewer

#include "formats/path/path_file.h"

#include <charconv>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <span>
#include <system_error>

#include "formats/path/path_columns.h"

namespace forcelayer {
namespace {

constexpr const char* kHeader = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
constexpr const char* kMend =
    "a path has the columns t_s,x_m,y_m,z_m and either qw,qx,qy,qz or rx_deg,ry_deg,rz_deg. Other "
    "units, such as x_mm, are possible";
constexpr const char* kWanted = "give a CSV file of poses, in UTF-8";
constexpr std::size_t kMaxLine = 4096;  // bytes
constexpr std::size_t kFlushBytes = 1 << 20;

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t' || text.front() == '\r')) {
    text.remove_prefix(1);
  }
  return text;
}

// A finite number. Where cells are not separated by commas, a comma may stand in it for the point.
bool parse_number(std::string_view cell, char separator, double& number) {
  if (!cell.empty() && cell.front() == '+') cell.remove_prefix(1);
  char with_point[64];
  if (separator != ',' && cell.find(',') != std::string_view::npos) {
    if (cell.size() > sizeof with_point) return false;
    for (std::size_t i = 0; i < cell.size(); ++i) with_point[i] = cell[i] == ',' ? '.' : cell[i];
    cell = {with_point, cell.size()};
  }
  const auto [end, failure] = std::from_chars(cell.data(), cell.data() + cell.size(), number);
  return failure == std::errc{} && end == cell.data() + cell.size() && std::isfinite(number);
}

// Reads the values of a line, in SI units. Returns the mistake where it has one; empty: none.
std::string parse_line(std::string_view line, const PathColumns& columns,
                       PathColumns::Values& values) {
  const std::size_t wanted = columns.value_of.size();
  std::size_t cells = 0;
  for (; line.data(); ++cells) {
    const std::string_view cell = take_cell(line, columns.separator);
    if (cells >= wanted || columns.value_of[cells] == columns.kOther) continue;
    const auto at = static_cast<std::size_t>(columns.value_of[cells]);
    if (parse_number(cell, columns.separator, values[at]) &&
        std::isfinite(values[at] *= columns.factor[at])) {
      continue;
    }
    return name_of(columns, at) + " is " + in_quotes(cell) + ", not a finite number like -1.5e-3";
  }
  if (cells == wanted) return {};
  return "has " + std::to_string(cells) + " cells, but the header has " + std::to_string(wanted);
}

// The kind of a file that Forcelayer did not write, by its first line; nullptr: it may be.
const char* other_kind(std::string_view line) {
  static constexpr struct {
    char begin[5], name[12];
  } kKinds[] = {{"{", "JSON"},
                {"[", "JSON"},
                {"PK\3\4", "a workbook"},
                {"\211FLV", "a .vox"},
                {"\211FLP", "a .pshell"},
                {"\211FLR", "a recording"}};
  for (const auto& kind : kKinds) {
    if (without_blanks(line).starts_with(kind.begin)) return kind.name;
  }
  return line.find('\0') != std::string_view::npos ? "UTF-16 or binary" : nullptr;
}

// Lines of a file, one after the other, without holding more of it than one.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& path) : file_(path) {}

  // False at the end. A line that is too long is an error of ok().
  bool next(std::string_view& line) {
    if (!(file_.getline(buffer_.data(), kMaxLine + 1) || file_.gcount() > 0)) {
      ended_ = true;
      return false;
    }
    ++number_;
    if (!file_ && !file_.eof()) {
      too_long_ = true;
      return false;
    }
    const auto length = static_cast<std::size_t>(file_.gcount()) - (file_.eof() ? 0 : 1);
    line = {buffer_.data(), length};
    if (number_ == 1 && line.starts_with("\xef\xbb\xbf")) line.remove_prefix(3);
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return true;
  }
  std::size_t number() const { return number_; }
  bool ended() const { return ended_; }
  bool too_long() const { return too_long_; }
  bool failed() const { return file_.bad() || (!file_.eof() && number_ == 0); }

 private:
  std::ifstream file_;
  std::array<char, kMaxLine + 1> buffer_{};
  std::size_t number_ = 0;
  bool ended_ = false, too_long_ = false;
};

bool is_within_limits(const PathRow& row) {
  const auto is_near = [](double x_m) { return std::abs(x_m) <= kFarthestPathM; };
  return std::abs(row.time_s) <= kLatestPathS && is_near(row.position_m[0]) &&
         is_near(row.position_m[1]) && is_near(row.position_m[2]);
}

bool is_comment(std::string_view line) {
  line = without_blanks(line);
  return line.empty() || line.front() == '#';
}

}  // namespace

Result<std::vector<PathRow>> read_path(const std::filesystem::path& path, PathOf of) {
  std::error_code failure;
  if (!std::filesystem::exists(path, failure) || std::filesystem::is_directory(path, failure)) {
    return Error{ErrorCode::kFileNotFound, path.string(), "", "no such file", kWanted};
  }
  LineReader lines(path);
  const auto wrong = [&](std::string_view what, const char* mend = "") {
    const std::size_t line = lines.number() + (lines.ended() ? 1 : 0);
    return Error{ErrorCode::kUsage, path.string(), "line " + std::to_string(line), what, mend};
  };
  PathColumns columns;
  PathColumns::Values before{};
  std::vector<PathRow> rows;
  for (std::string_view line; lines.next(line);) {
    if (lines.number() == 1) {
      if (const char* const kind = other_kind(line)) {
        return wrong(std::string("is ") + kind, kWanted);
      }
    }
    if (is_comment(line)) continue;
    if (columns.value_of.empty()) {
      if (line.starts_with("sep=")) continue;  // of a spreadsheet
      const std::string mistake = read_path_header(line, of, columns);
      if (!mistake.empty()) return wrong(mistake, kMend);
      continue;
    }
    PathColumns::Values values{};
    const std::string mistake = parse_line(line, columns, values);
    if (!mistake.empty()) return wrong(mistake);
    const auto row = path_row(columns, values);
    if (!row) return wrong("has a quaternion of length zero");
    if (!is_within_limits(*row))
      return wrong("has a coordinate above 1e9 m or a time above 1e12 s");
    if (!rows.empty()) {
      if (!(row->time_s > rows.back().time_s)) {
        char times[128];
        std::snprintf(times, sizeof times,
                      "the time %.15g s is not later than %.15g s in the row before", row->time_s,
                      rows.back().time_s);
        return wrong(times);
      }
      if (const auto turn = open_turn(before, values, rows.back(), *row)) {
        return wrong(name_of(columns, *turn) + " turns by 180 degrees or more in one step",
                     "add rows before it, so that the direction of the turn is known");
      }
    }
    if (rows.size() == kMaxPathRows) return wrong("is beyond the limit of 100 million rows");
    rows.push_back(*row);
    before = values;
  }
  if (lines.too_long()) return wrong("is longer than 4096 bytes");
  if (lines.failed()) {
    return Error{ErrorCode::kReadFailed, path.string(), "", "cannot be read", ""};
  }
  if (rows.empty()) {
    return wrong(columns.value_of.empty() ? "the header is missing" : "the file has no poses");
  }
  return rows;
}

Result<PathWriter> PathWriter::create(const std::filesystem::path& path) {
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  PathWriter writer(std::move(*file));
  writer.text_ = kHeader;
  return writer;
}

// Each number as the shortest text that reads back as the same.
Status PathWriter::add(const PathRow& row) {
  const double values[] = {row.time_s,
                           row.position_m[0],
                           row.position_m[1],
                           row.position_m[2],
                           row.orientation_wxyz[0],
                           row.orientation_wxyz[1],
                           row.orientation_wxyz[2],
                           row.orientation_wxyz[3]};
  bool readable = row.time_s > last_s_ && is_within_limits(row);
  last_s_ = row.time_s;
  for (const double value : values) {
    readable &= std::isfinite(value);
    char digits[32];
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
    text_ += ',';
  }
  if (!readable)
    return file_.refused("a pose is too far away, not finite, or not later than the pose before");
  text_.back() = '\n';
  return text_.size() < kFlushBytes ? Status{} : flush();
}

Status PathWriter::flush() {
  Status written = file_.write(std::as_bytes(std::span(text_)));
  text_.clear();
  return written;
}

Status PathWriter::finish() {
  if (std::isinf(last_s_)) return file_.refused("the path has no poses");
  if (Status written = flush(); !written) return written;
  return file_.commit();
}

}  // namespace forcelayer

#include "formats/path/path_file.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <span>
#include <system_error>

#include "formats/path/path_columns.h"

namespace forcelayer {
namespace {

constexpr const char* kHeader = "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n";
constexpr std::size_t kMaxLine = 4096;  // bytes
constexpr std::size_t kFlushBytes = 1 << 20;

Error line_error(const std::filesystem::path& path, std::size_t line, std::string what) {
  return {ErrorCode::kUsage, path.string(), "line " + std::to_string(line), std::move(what),
          "a path has the columns t_s,x_m,y_m,z_m,qw,qx,qy,qz, in these or other units"};
}

std::string_view without_blanks(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r')) {
    text.remove_suffix(1);
  }
  return text;
}

// A finite number. Where cells are not separated by commas, a comma may stand in it for the point.
bool parse_number(std::string_view cell, char separator, double& number) {
  cell = without_blanks(cell);
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

// The length of the first cell: up to the separator, but for one in quotes.
std::size_t cell_length(std::string_view line, char separator) {
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') quoted = !quoted;
    if (line[i] == separator && !quoted) return i;
  }
  return line.size();
}

// The values of a line, in SI units. False where there are more or fewer cells than the header has,
// or no numbers.
bool parse_line(std::string_view line, const PathColumns& columns,
                std::array<double, PathColumns::kValues>& values) {
  for (std::size_t cell = 0; cell < columns.cells; ++cell) {
    const std::size_t length = cell_length(line, columns.separator);
    if (const int value = columns.value_of[cell]; value >= 0) {
      const auto at = static_cast<std::size_t>(value);
      if (!parse_number(line.substr(0, length), columns.separator, values[at])) return false;
      values[at] *= columns.factor[at];
      if (!std::isfinite(values[at])) return false;
    }
    if (length == line.size()) return cell + 1 == columns.cells;
    line.remove_prefix(length + 1);
  }
  return false;
}

// Lines of a file, one after the other, without holding more of it than one.
class LineReader {
 public:
  explicit LineReader(const std::filesystem::path& path) : file_(path) {}

  // False at the end. A line that is too long is an error of ok().
  bool next(std::string_view& line) {
    if (too_long_ || !(file_.getline(buffer_.data(), kMaxLine + 1) || file_.gcount() > 0)) {
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
  bool too_long() const { return too_long_; }
  bool failed() const { return file_.bad() || (!file_.eof() && number_ == 0); }

 private:
  std::ifstream file_;
  std::array<char, kMaxLine + 1> buffer_{};
  std::size_t number_ = 0;
  bool too_long_ = false;
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
    return Error{ErrorCode::kFileNotFound, path.string(), "", "no such file",
                 "give a CSV file of poses"};
  }
  LineReader lines(path);
  PathColumns columns;
  std::vector<PathRow> rows;
  bool has_header = false;
  for (std::string_view line; lines.next(line);) {
    if (is_comment(line)) continue;
    if (!has_header) {
      if (const auto wrong = read_path_header(line, of, columns)) {
        return line_error(path, lines.number(), *wrong);
      }
      has_header = true;
      continue;
    }
    std::array<double, PathColumns::kValues> values{};
    if (!parse_line(line, columns, values)) {
      return line_error(path, lines.number(),
                        "is not " + std::to_string(columns.cells) +
                            " cells with finite numbers where the header wants them");
    }
    const auto row = path_row(columns, values);
    if (!row) return line_error(path, lines.number(), "has a quaternion without direction");
    if (!is_within_limits(*row)) {
      return line_error(path, lines.number(), "is farther than 1e9 m, or than 1e12 s");
    }
    if (!rows.empty() && !(row->time_s > rows.back().time_s)) {
      return line_error(path, lines.number(), "is not later than the line before");
    }
    if (rows.size() == kMostPathRows) {
      return line_error(path, lines.number(), "is beyond 100 million rows");
    }
    rows.push_back(*row);
  }
  if (lines.too_long()) return line_error(path, lines.number(), "is longer than 4096 bytes");
  if (lines.failed()) {
    return Error{ErrorCode::kReadFailed, path.string(), "", "cannot be read", ""};
  }
  if (rows.empty()) {
    return line_error(path, lines.number() + 1,
                      has_header ? "is missing: there are no poses" : "is missing: the header");
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
    return file_.refused("a pose is not finite, too far, or not later than the one before");
  text_.back() = '\n';
  return text_.size() < kFlushBytes ? Status{} : flush();
}

Status PathWriter::flush() {
  Status written = file_.write(std::as_bytes(std::span(text_)));
  text_.clear();
  return written;
}

Status PathWriter::finish() {
  if (std::isinf(last_s_)) return file_.refused("there are no poses");
  if (Status written = flush(); !written) return written;
  return file_.commit();
}

}  // namespace forcelayer

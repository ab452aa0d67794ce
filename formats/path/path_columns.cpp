#include "formats/path/path_columns.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "formats/path/quaternion.h"

namespace forcelayer {
namespace {

constexpr double kRadPerDeg = 0.017453292519943295;
constexpr std::size_t kQuaternion = 4, kAngles = 8;  // the first values of either kind of turn

// Characters rather than pointers to them: a table without relocations.
constexpr char kStems[][5] = {"time", "t", "x", "y", "z", "qw", "qx", "qy", "qz", "rx", "ry", "rz"};
// Units of time, of length and of angles; those of a kind begin at kFirst.
constexpr char kUnits[][4] = {"s",  "ms", "us", "min", "m",   "mm",      "cm",
                              "um", "in", "ft", "rad", "deg", "\xc2\xb0"};
constexpr double kFactors[] = {1,    1e-3,   1e-6,   60, 1,          1e-3,      1e-2,
                               1e-6, 0.0254, 0.3048, 1,  kRadPerDeg, kRadPerDeg};
static_assert(std::size(kUnits) == std::size(kFactors));
enum Kind { kTime, kLength, kAngle, kNone };
constexpr std::uint8_t kFirst[] = {0, 4, 10, std::size(kUnits)};

Kind kind_of(std::size_t value) {
  if (value == 0) return kTime;
  return value < kQuaternion ? kLength : value < kAngles ? kNone : kAngle;
}

// The name in one spelling: "Part X [mm]" is part_x_mm.
std::string plain(std::string_view name) {
  std::string word;
  bool gap = false;
  for (char c : name) {
    if (std::string_view(" _[](/).").find(c) != std::string_view::npos) {
      gap = !word.empty();
      continue;
    }
    if (gap) word += '_';
    gap = false;
    word += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return word;
}

// The number of the value that a plain name means, with the factor of its unit; kOther: none.
std::size_t value_of(std::string_view word, double& factor) {
  const std::size_t end = std::min(word.find('_'), word.size());
  const std::string_view stem = word.substr(0, end);
  const std::string_view unit = word.substr(std::min(end + 1, word.size()));
  for (std::size_t i = 0; i < std::size(kStems); ++i) {
    if (stem != kStems[i]) continue;
    const std::size_t value = i > 0 ? i - 1 : 0;
    const Kind kind = kind_of(value);
    if (kind == kNone) {
      factor = 1;
      return unit.empty() ? value : PathColumns::kOther;
    }
    for (std::size_t known = kFirst[kind]; known < kFirst[kind + 1]; ++known) {
      if (unit != kUnits[known]) continue;
      factor = kFactors[known];
      return value;
    }
  }
  return PathColumns::kOther;
}

// Whether a plain name may be that of a turn, in whatever convention. Rather too many are: they can
// be called something else, and a turn that is not read is a part that is checked unturned.
bool may_be_turn(std::string_view word) {
  if (word.size() == 1) return word[0] == 'w' || (word[0] >= 'a' && word[0] <= 'c');
  constexpr char kEnds[][8] = {"deg", "rad", "degrees", "radians"};
  for (const auto& end : kEnds) {
    if (word.ends_with(end)) return true;
  }
  constexpr char kWords[][7] = {"rot",   "quat", "orient", "euler", "angle",
                                "pitch", "yaw",  "roll",   "rpy",   "headin"};
  while (true) {
    for (const auto& begin : kWords) {
      if (word.starts_with(begin)) return true;
    }
    // q and an axis or a number, r and an axis, with and without a gap.
    const std::size_t end = std::min(word.find('_'), word.size());
    std::string_view axis = word.substr(std::min<std::size_t>(1, word.size()));
    if (axis.starts_with('_')) axis.remove_prefix(1);
    if (!axis.empty() && (axis.size() == 1 || axis[1] == '_')) {
      if (word[0] == 'q' && std::strchr("wxyz01234", axis[0])) return true;
      if (word[0] == 'r' && axis[0] >= 'x' && axis[0] <= 'z') return true;
    }
    if (end == word.size()) return false;
    word.remove_prefix(end + 1);
  }
}

// Turns about the world's axes: x first, then y, then z.
Quaternion turned(const double* about_rad) {
  double c[3], s[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    c[axis] = std::cos(about_rad[axis] / 2);
    s[axis] = std::sin(about_rad[axis] / 2);
  }
  const double cc = c[1] * c[2], ss = s[1] * s[2], cs = c[1] * s[2], sc = s[1] * c[2];
  return {c[0] * cc + s[0] * ss, s[0] * cc - c[0] * ss, c[0] * sc + s[0] * cs,
          c[0] * cs - s[0] * sc};
}

std::string message(const char* pattern, const std::string& a, const std::string& b = {}) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, a.c_str(), b.c_str());
  return text;
}

// The cell that holds a value; npos where none does.
std::size_t cell_of(const PathColumns& columns, std::size_t value) {
  return columns.value_of.find(static_cast<char>(value));
}

bool has(const PathColumns& columns, std::size_t value) {
  return cell_of(columns, value) != std::string::npos;
}

}  // namespace

std::string_view take_cell(std::string_view& line, char separator) {
  const auto is_blank = [&](char c) {
    return (c == ' ' || c == '\t' || c == '\r') && c != separator;
  };
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  std::size_t end = 0;
  if (line.starts_with('"')) {
    bool quoted = false;
    for (; end < line.size() && (quoted || line[end] != separator); ++end) {
      quoted ^= line[end] == '"';
    }
  } else {
    end = std::min(line.find(separator), line.size());
  }
  std::string_view cell = line.substr(0, end);
  line = end < line.size() ? line.substr(end + 1) : std::string_view();
  while (!cell.empty() && (is_blank(cell.back()) || cell.back() == '"')) cell.remove_suffix(1);
  while (!cell.empty() && (is_blank(cell.front()) || cell.front() == '"')) cell.remove_prefix(1);
  return cell;
}

std::string in_quotes(std::string_view text) {
  std::size_t shown = std::min<std::size_t>(text.size(), 40);
  // Not within a character.
  while (shown > 0 && shown < text.size() && (text[shown] & 0xc0) == 0x80) --shown;
  return '\'' + escaped(text.substr(0, shown)) + (shown < text.size() ? "...'" : "'");
}

std::string name_of(const PathColumns& columns, std::size_t value) {
  std::string_view line = columns.header, name;
  for (std::size_t cell = cell_of(columns, value) + 1; cell > 0; --cell) {
    name = take_cell(line, columns.separator);
  }
  return in_quotes(name);
}

std::string read_path_header(std::string_view line, PathOf of, PathColumns& columns) {
  columns.header = line;
  for (const char separator : {'\t', ';'}) {
    if (line.find(separator) != std::string_view::npos) columns.separator = separator;
  }
  constexpr const char* kBoth = "has both %s and %s: leave one out";
  const char *own = "part_", *other = "handle_";
  if (of == PathOf::kHandle) std::swap(own, other);
  // A trace has a prefix before the names that are wanted. First it is seen whether this is one.
  bool is_trace = false;
  for (const bool first : {true, false}) {
    for (std::string_view rest = line; rest.data();) {
      const std::string_view name = take_cell(rest, columns.separator);
      const std::string all = plain(name);
      std::string_view word = all;
      const bool is_own = word.starts_with(own);
      if (is_own) word.remove_prefix(std::strlen(own));
      if (first) {
        is_trace |= is_own && word.starts_with("x_");
        continue;
      }
      double factor = 0;
      std::size_t value = value_of(word, factor);
      if (is_own != (is_trace && value > 0)) value = columns.kOther;
      if (value != columns.kOther) {
        if (has(columns, value)) {
          return message(kBoth, name_of(columns, value), in_quotes(name));
        }
        columns.factor[value] = factor;
      } else if (!word.starts_with(other) && may_be_turn(word)) {
        return message("has %s, which may be a rotation in an unknown form: rename this column",
                       in_quotes(name));
      }
      columns.value_of += static_cast<char>(value);
    }
  }
  if (columns.value_of.size() == 1) return "has no comma, semicolon or tab";
  std::size_t turns = 0;
  for (std::size_t value = kQuaternion; value < kAngles; ++value) turns += has(columns, value);
  for (std::size_t value = 0; value < (turns > 0 ? kAngles : kQuaternion); ++value) {
    if (has(columns, value)) continue;
    const std::string stem = (is_trace && value > 0 ? own : std::string()) + kStems[value + 1];
    const char* const wanted = value == 0            ? "has no column %s_s or %s_ms"
                               : value < kQuaternion ? "has no column %s_m or %s_mm"
                                                     : "has no column %s";
    return message(wanted, stem, stem);
  }
  for (std::size_t value = kAngles; turns > 0 && value < columns.kValues; ++value) {
    if (has(columns, value)) {
      return message(kBoth, name_of(columns, kQuaternion), name_of(columns, value));
    }
  }
  return {};
}

std::optional<PathRow> path_row(const PathColumns& columns, const PathColumns::Values& v) {
  PathRow row{v[0], {v[1], v[2], v[3]}, {1, 0, 0, 0}};
  Quaternion q =
      has(columns, kQuaternion) ? Quaternion{v[4], v[5], v[6], v[7]} : turned(&v[kAngles]);
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(length > 1e-6) || !std::isfinite(length)) return std::nullopt;
  for (double& part : q) part /= length;
  row.orientation_wxyz = q;
  return row;
}

std::optional<std::size_t> open_turn(const PathColumns::Values& a, const PathColumns::Values& b,
                                     const PathRow& from, const PathRow& to) {
  // Less than half a turn and a quarter turn by far more than their rounding.
  constexpr double kHalfTurnRad = 180 * kRadPerDeg * (1 - 1e-9), kCosine = 0.7071067;
  double cosine = 0;  // of half the angle between the poses
  for (std::size_t i = 0; i < 4; ++i) cosine += from.orientation_wxyz[i] * to.orientation_wxyz[i];
  const bool apart = std::abs(cosine) < kCosine;
  for (std::size_t value = kAngles; value < a.size(); ++value) {
    const double turn_rad = std::abs(a[value] - b[value]);
    if (turn_rad >= (apart ? 1 : 2) * kHalfTurnRad) return value;
  }
  return std::nullopt;
}

}  // namespace forcelayer

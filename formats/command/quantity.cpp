#include "formats/command/quantity.h"

#include <charconv>
#include <cmath>
#include <string>
#include <vector>

namespace forcelayer {
namespace {

struct NamedFactor {
  std::string_view name;
  double factor;
};

constexpr NamedFactor kLengthUnits[] = {{"nm", 1e-9},   {"um", 1e-6},  {"mm", 1e-3}, {"cm", 1e-2},
                                        {"dm", 1e-1},   {"m", 1.0},    {"km", 1e3},  {"in", 0.0254},
                                        {"ft", 0.3048}, {"yd", 0.9144}};
constexpr NamedFactor kTimeUnits[] = {
    {"us", 1e-6}, {"ms", 1e-3}, {"s", 1.0}, {"min", 60.0}, {"h", 3600.0}};

Error usage(std::string what, std::string mend) {
  return {ErrorCode::kUsage, "", "", std::move(what), std::move(mend)};
}

std::string quoted(std::string_view text) { return "'" + std::string(text) + "'"; }

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

// A number and the rest of the text after it.
struct NumberAndRest {
  double number;
  std::string_view rest;
};

Result<NumberAndRest> split_number(std::string_view text) {
  text = trimmed(text);
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double number = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failure != std::errc{} || !std::isfinite(number)) {
    return usage(quoted(text) + " is not a finite number", "write it like 5mm or 0.005m");
  }
  return NumberAndRest{number, trimmed(text.substr(static_cast<std::size_t>(end - text.data())))};
}

std::vector<std::string_view> split_commas(std::string_view text) {
  std::vector<std::string_view> parts;
  for (;;) {
    const auto comma = text.find(',');
    parts.push_back(text.substr(0, comma));
    if (comma == std::string_view::npos) return parts;
    text.remove_prefix(comma + 1);
  }
}

// One component of a vector: metres where it has no unit.
Result<double> parse_component(std::string_view text) {
  const auto split = split_number(text);
  if (!split) return split.error();
  if (split->rest.empty()) return split->number;
  const auto unit = parse_unit(split->rest);
  if (!unit) return unit.error();
  return split->number * *unit;
}

template <std::size_t kCount>
Result<std::array<double, kCount>> parse_components(std::string_view text, const char* form) {
  const auto parts = split_commas(text);
  if (parts.size() != kCount) {
    return usage(quoted(text) + " has " + std::to_string(parts.size()) + " numbers instead of " +
                     std::to_string(kCount),
                 std::string("write it as ") + form);
  }
  std::array<double, kCount> values{};
  for (std::size_t i = 0; i < kCount; ++i) {
    const auto value = parse_component(parts[i]);
    if (!value) return value.error();
    values[i] = *value;
  }
  return values;
}

}  // namespace

Result<double> parse_unit(std::string_view unit) {
  for (const auto& [name, metres] : kLengthUnits) {
    if (unit == name) return metres;
  }
  return usage(quoted(unit) + " is not a unit of length",
               "use one of nm, um, mm, cm, dm, m, km, in, ft, yd");
}

Result<double> parse_length(std::string_view text) {
  const auto split = split_number(text);
  if (!split) return split.error();
  if (split->rest.empty()) {
    if (split->number == 0) return 0.0;
    return usage("length " + quoted(text) + " has no unit", "write it like 5mm or 0.005m");
  }
  const auto unit = parse_unit(split->rest);
  if (!unit) return unit.error();
  return split->number * *unit;
}

Result<std::array<double, 3>> parse_point(std::string_view text) {
  return parse_components<3>(text, "x,y,z");
}

Result<std::array<double, 6>> parse_box(std::string_view text) {
  auto box = parse_components<6>(text, "x0,y0,z0,x1,y1,z1");
  if (!box) return box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!((*box)[axis] < (*box)[axis + 3])) {
      return usage("box " + quoted(text) + " is empty", "write its lowest corner first");
    }
  }
  return box;
}

Result<PoseText> parse_pose(std::string_view text) {
  PoseText pose;
  if (split_commas(text).size() == 3) {
    const auto position = parse_point(text);
    if (!position) return position.error();
    pose.position_m = *position;
    return pose;
  }
  const auto parts = split_commas(text);
  if (parts.size() != 7) {
    return usage("pose " + quoted(text) + " has " + std::to_string(parts.size()) + " numbers",
                 "write it as x,y,z or x,y,z,qw,qx,qy,qz");
  }
  double norm2 = 0;
  for (std::size_t i = 0; i < 7; ++i) {
    if (i < 3) {
      const auto metres = parse_component(parts[i]);
      if (!metres) return metres.error();
      pose.position_m[i] = *metres;
      continue;
    }
    const auto number = split_number(parts[i]);
    if (!number) return number.error();
    if (!number->rest.empty()) {
      return usage("the quaternion of pose " + quoted(text) + " has a unit",
                   "write it as x,y,z,qw,qx,qy,qz");
    }
    pose.orientation_wxyz[i - 3] = number->number;
    norm2 += number->number * number->number;
  }
  if (!(norm2 > 1e-24) || !std::isfinite(norm2)) {
    return usage("the quaternion of pose " + quoted(text) + " has no direction",
                 "the identity is 1,0,0,0");
  }
  for (double& component : pose.orientation_wxyz) component /= std::sqrt(norm2);
  return pose;
}

Result<double> parse_duration(std::string_view text) {
  const auto split = split_number(text);
  if (!split) return split.error();
  for (const auto& [name, seconds] : kTimeUnits) {
    if (split->rest == name) return split->number * seconds;
  }
  return usage("duration " + quoted(text) + " has no unit of time", "write it like 10s or 500ms");
}

}  // namespace forcelayer

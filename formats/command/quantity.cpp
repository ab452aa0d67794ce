#include "formats/command/quantity.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

namespace forcelayer::command {
namespace {

// A unit is `factor` times ten to the `exponent` of the base unit. The power of ten is applied to
// the number's text, so that 1.1mm and 0.0011m are the same double.
struct Unit {
  std::string_view name;
  int exponent;
  double factor;
};

constexpr Unit kLengthUnits[] = {
    {"nm", -9, 1}, {"um", -6, 1}, {"mm", -3, 1},     {"cm", -2, 1},     {"dm", -1, 1},
    {"m", 0, 1},   {"km", 3, 1},  {"in", 0, 0.0254}, {"ft", 0, 0.3048}, {"yd", 0, 0.9144}};

// Other spellings of units of length. The two micrometers are those of the signs U+00B5 and U+03BC.
struct Spelling {
  std::string_view text, unit;
};
constexpr Spelling kSpellings[] = {
    {"\xC2\xB5m", "um"}, {"\xCE\xBCm", "um"}, {"\"", "in"},   {"inch", "in"}, {"NM", "nm"},
    {"UM", "um"},        {"MM", "mm"},        {"CM", "cm"},   {"DM", "dm"},   {"M", "m"},
    {"KM", "km"},        {"IN", "in"},        {"INCH", "in"}, {"FT", "ft"},   {"YD", "yd"}};
constexpr Unit kTimeUnits[] = {
    {"us", -6, 1}, {"ms", -3, 1}, {"s", 0, 1}, {"min", 0, 60}, {"h", 0, 3600}};
constexpr Unit kForceUnits[] = {{"mN", -3, 1}, {"N", 0, 1}, {"kN", 3, 1}};
constexpr Unit kPressureUnits[] = {{"Pa", 0, 1}, {"kPa", 3, 1}, {"MPa", 6, 1}};

Error usage(std::string_view what, std::string_view mend) {
  return {ErrorCode::kUsage, "", "", what, mend};
}

std::string quoted(std::string_view text) { return "'" + std::string(text) + "'"; }

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

Error not_a_number(std::string_view text) {
  return usage(quoted(text) + " is not a finite number", "write it like 5mm or 0.005m");
}

// A finite number, its text, and the text after it.
struct NumberAndRest {
  double number;
  std::string_view text;
  std::string_view rest;
};

Result<NumberAndRest> split_number(std::string_view text) {
  text = trimmed(text);
  std::string_view digits = text;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  double number = 0;
  const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (failure != std::errc{} || !std::isfinite(number)) return not_a_number(text);
  const auto length = static_cast<std::size_t>(end - digits.data());
  return NumberAndRest{number, digits.substr(0, length), trimmed(digits.substr(length))};
}

// The number of `split` in base units, correctly rounded where the unit is a power of ten.
Result<double> scaled(const NumberAndRest& split, const Unit& unit) {
  if (split.number == 0) return split.number;  // whatever its exponent: 0e2147483647
  const auto e = split.text.find_first_of("eE");
  long long exponent = unit.exponent;
  if (e != std::string_view::npos) {
    const std::size_t sign = split.text[e + 1] == '+' ? 1 : 0;
    int own = 0;  // stays 0 for a zero, which any exponent may follow
    std::from_chars(split.text.data() + e + 1 + sign, split.text.data() + split.text.size(), own);
    exponent += own;
  }
  const std::string shifted = std::string(split.text.substr(0, e)) + "e" + std::to_string(exponent);
  double number = 0;
  const auto parsed = std::from_chars(shifted.data(), shifted.data() + shifted.size(), number);
  number *= unit.factor;
  if (parsed.ec != std::errc{} || !std::isfinite(number)) {
    return not_a_number(std::string(split.text) + std::string(unit.name));
  }
  return number;
}

const Unit* find_unit(std::span<const Unit> units, std::string_view name) {
  const auto found = std::find_if(units.begin(), units.end(),
                                  [name](const Unit& unit) { return unit.name == name; });
  return found == units.end() ? nullptr : &*found;
}

const Unit* find_length_unit(std::string_view name) {
  const auto other =
      std::find_if(std::begin(kSpellings), std::end(kSpellings),
                   [name](const Spelling& spelling) { return spelling.text == name; });
  return find_unit(kLengthUnits, other == std::end(kSpellings) ? name : other->unit);
}

Error unknown_length_unit(std::string_view name) {
  return usage(quoted(name) + " is not a unit of length",
               "use one of nm, um, mm, cm, dm, m, km, in, ft, yd");
}

Result<double> scaled_length(const NumberAndRest& split) {
  const Unit* unit = find_length_unit(split.rest);
  return unit ? scaled(split, *unit) : Result<double>(unknown_length_unit(split.rest));
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

Result<double> parse_bare(std::string_view text, std::string_view) {
  const auto split = split_number(text);
  if (!split) return split.error();
  if (split->rest.empty()) return split->number;
  return usage(quoted(trimmed(text)) + " must be a number without a unit", "leave the unit out");
}

// Adds `unit` to a bare number.
Result<double> parse_length_in(std::string_view text, std::string_view unit) {
  const auto split = split_number(text);
  const bool bare = split && split->rest.empty();
  return parse_length(bare ? std::string(text).append(unit) : std::string(text));
}

// The unit of the last of a vector's lengths, where no other has one: it is that of all.
std::string_view common_unit(std::span<const std::string_view> parts) {
  std::string_view unit;
  for (const std::string_view part : parts) {
    const auto split = split_number(part);
    if (!unit.empty() || !split) return {};
    unit = split->rest;
  }
  return unit;
}

using ParseComponent = Result<double> (*)(std::string_view text, std::string_view unit);

template <std::size_t kCount>
Result<std::array<double, kCount>> parse_components(std::string_view text, const char* form,
                                                    ParseComponent parse_component) {
  const auto parts = split_commas(text);
  if (parts.size() != kCount) {
    return usage(quoted(text) + " has " + std::to_string(parts.size()) + " numbers instead of " +
                     std::to_string(kCount),
                 std::string("write it as ") + form);
  }
  const std::string_view unit = common_unit(parts);
  std::array<double, kCount> values{};
  for (std::size_t i = 0; i < kCount; ++i) {
    const auto value = parse_component(parts[i], unit);
    if (!value) return value.error();
    values[i] = *value;
  }
  return values;
}

// Four bare numbers, normalized; `pose` is the whole text, for errors.
Result<std::array<double, 4>> parse_quaternion(std::span<const std::string_view> parts,
                                               std::string_view pose) {
  std::array<double, 4> wxyz{};
  double norm2 = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto number = split_number(parts[i]);
    if (!number) return number.error();
    if (!number->rest.empty()) {
      return usage("pose " + quoted(pose) + " has a unit in its quaternion",
                   "write x,y,z,qw,qx,qy,qz, and units only for x, y and z");
    }
    wxyz[i] = number->number;
    norm2 += number->number * number->number;
  }
  if (!(norm2 > 1e-24) || !std::isfinite(norm2)) {
    return usage(
        "the quaternion of pose " + quoted(pose) + " has a norm that is 0, too small or not finite",
        "write 1,0,0,0 for no rotation");
  }
  for (double& component : wxyz) component /= std::sqrt(norm2);
  return wxyz;
}

}  // namespace

Result<double> parse_unit(std::string_view unit) {
  const Unit* found = find_length_unit(unit);
  if (!found) return unknown_length_unit(unit);
  return scaled({1, "1", ""}, *found);
}

Result<double> parse_length(std::string_view text) {
  const auto split = split_number(text);
  if (!split) return split.error();
  if (split->rest.empty() && split->number == 0) return 0.0;
  if (split->rest.empty()) {
    return usage("length " + quoted(trimmed(text)) + " has no unit", "write it like 5mm or 0.005m");
  }
  auto meters = scaled_length(*split);
  if (meters && std::abs(*meters) > kFarthestM) {
    return usage("length " + quoted(trimmed(text)) + " is longer than 1e9m",
                 "check the number and the unit");
  }
  return meters;
}

Result<std::array<double, 3>> parse_point(std::string_view text) {
  return parse_components<3>(text, "x,y,z", parse_length_in);
}

Result<std::array<double, 3>> parse_direction(std::string_view text) {
  return parse_components<3>(text, "x,y,z", parse_bare);
}

Result<std::array<double, 6>> parse_box(std::string_view text) {
  auto box = parse_components<6>(text, "x0,y0,z0,x1,y1,z1", parse_length_in);
  if (!box) return box;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!((*box)[axis] < (*box)[axis + 3])) {
      return usage("box " + quoted(text) + " is empty", "write its lowest corner first");
    }
  }
  return box;
}

Result<PoseText> parse_pose(std::string_view text) {
  const auto parts = split_commas(text);
  if (parts.size() != 3 && parts.size() != 7) {
    return usage("pose " + quoted(text) + " has " + std::to_string(parts.size()) + " numbers",
                 "write it as x,y,z or x,y,z,qw,qx,qy,qz");
  }
  const std::string_view unit = common_unit(std::span(parts).first(3));
  PoseText pose;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto meters = parse_length_in(parts[axis], unit);
    if (!meters) return meters.error();
    pose.position_m[axis] = *meters;
  }
  if (parts.size() == 3) return pose;
  const auto orientation = parse_quaternion(std::span(parts).subspan(3), text);
  if (!orientation) return orientation.error();
  pose.orientation_wxyz = *orientation;
  return pose;
}

Result<double> parse_duration(std::string_view text) {
  const auto split = split_number(text);
  if (!split) return split.error();
  const Unit* unit = find_unit(kTimeUnits, split->rest);
  if (!unit) {
    return usage("duration " + quoted(text) + " has no unit of time", "write it like 10s or 500ms");
  }
  if (split->number < 0) {
    return usage("duration " + quoted(text) + " is negative", "use zero or more");
  }
  const auto seconds = scaled(*split, *unit);
  if (seconds && *seconds > kLongestS) {
    return usage("duration " + quoted(text) + " is longer than 10000h",
                 "check the number and the unit");
  }
  return seconds;
}

Error about(std::string option, Error error) {
  error.where = std::move(option);
  return error;
}

std::string to_text(const Bounds& bounds) {
  char text[80];
  std::snprintf(text, sizeof text, "%.6g to %.6g", bounds.smallest, bounds.largest);
  return text;
}

Result<double> parse_number(std::string_view text, const Bounds& bounds) {
  const auto split = split_number(text);
  if (!split || !split->rest.empty()) {
    const bool finite = bool(split);
    return usage(
        quoted(text) + (finite ? " must be a number without a unit" : " is not a finite number"),
        "give a number from " + to_text(bounds));
  }
  if (!(split->number >= bounds.smallest && split->number <= bounds.largest)) {
    return usage(quoted(text) + " is outside the allowed range",
                 "give a number from " + to_text(bounds));
  }
  return split->number;
}

Result<double> parse_pressure_pa(std::string_view text) {
  const auto split = split_number(text);
  if (!split) return split.error();
  if (find_unit(kForceUnits, split->rest)) {
    return usage(quoted(text) + " is a force, but a pressure is needed: force over area",
                 "write it like 5kPa, which is 0.5 N on 1 cm2");
  }
  const Unit* unit = find_unit(kPressureUnits, split->rest);
  if (!unit) {
    return usage("pressure " + quoted(text) + " has no unit of pressure",
                 "write it like 5kPa or 500Pa");
  }
  return scaled(*split, *unit);
}

}  // namespace forcelayer::command

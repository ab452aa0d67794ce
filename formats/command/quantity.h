// Numbers, lengths, vectors, poses and durations as they are typed on a command line. They are read
// alike in every locale and are finite; errors are kUsage. Metric units shift the decimal point of
// the text, so 1.1mm, 0.0011m and 1.1e-3m are the same double.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "formats/result.h"

namespace forcelayer::command {

// A pose from a command line: position and unit quaternion (w, x, y, z).
struct PoseText {
  std::array<double, 3> position_m{0, 0, 0};
  std::array<double, 4> orientation_wxyz{1, 0, 0, 0};
};

// The range of an option, both ends included.
struct Bounds {
  double smallest = 0;
  double largest = 0;
};

// "0.001 to 10"
std::string to_text(const Bounds& bounds);

// The error of one of the parsers below, with the option that it is about.
Error about(std::string option, Error error);

// A bare number within bounds.
Result<double> parse_number(std::string_view text, const Bounds& bounds);

// Meters in one `unit`: nm, um, mm, cm, dm, m, km, in, ft, yd; also in capitals, `inch`, `"`, and
// both signs for micro.
Result<double> parse_unit(std::string_view unit);

// "5mm", "0.2in", "0.005m" in meters. The unit is required: a bare number other than 0 is an error.
// At most kFarthestM either way, and so are the lengths of all that follows.
inline constexpr double kFarthestM = 1e9;
Result<double> parse_length(std::string_view text);

// The clearance that is required where none is given.
inline constexpr char kDefaultClearance[] = "1mm";

// "x,y,z", each a length as above; where the last alone has a unit, it is that of all:
// "0.1,0.1,5mm".
Result<std::array<double, 3>> parse_point(std::string_view text);

// "x,y,z", three bare numbers.
Result<std::array<double, 3>> parse_direction(std::string_view text);

// "x0,y0,z0,x1,y1,z1" in the same way, with x0 < x1 and so on.
Result<std::array<double, 6>> parse_box(std::string_view text);

// "x,y,z" or "x,y,z,qw,qx,qy,qz", x, y and z lengths as above; the quaternion is normalized and
// must not be zero.
Result<PoseText> parse_pose(std::string_view text);

// "10s", "500ms", "2min" in seconds; the unit is required, the number not negative, and the time at
// most kLongestS.
inline constexpr double kLongestS = 10'000 * 3600.0;
Result<double> parse_duration(std::string_view text);

// "5kPa", "500Pa", "0.1MPa" in pascals; the unit is required.
Result<double> parse_pressure_pa(std::string_view text);

}  // namespace forcelayer::command

// Sizes of boxes as a user reads them.
#pragma once

#include <algorithm>
#include <cstdio>
#include <string>

#include "formats/mesh/mesh.h"

namespace forcelayer::voxelize {

// "120 x 80 x 40 mm": a box whose sides times `factor` are in `unit`.
inline std::string size_text(const mesh::Box& box, double factor, const char* unit) {
  char text[120];
  std::snprintf(text, sizeof text, "%.4g x %.4g x %.4g %s", (box.high[0] - box.low[0]) * factor,
                (box.high[1] - box.low[1]) * factor, (box.high[2] - box.low[2]) * factor, unit);
  return text;
}

inline double longest_side(const mesh::Box& box) {
  double longest = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    longest = std::max(longest, box.high[axis] - box.low[axis]);
  }
  return longest;
}

// The same in millimeters, or in meters from ten meters on.
inline std::string size_text_m(const mesh::Box& box, double meters_per_unit) {
  constexpr double kLongestInMillimeters = 10;
  const bool in_meters = longest_side(box) * meters_per_unit >= kLongestInMillimeters;
  return size_text(box, meters_per_unit * (in_meters ? 1 : 1e3), in_meters ? "m" : "mm");
}

}  // namespace forcelayer::voxelize

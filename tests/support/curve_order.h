// The order in which pointshell writes points: along a space-filling curve.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace forcelayer::test {

// Numbers of the points of a part of this radius about the origin, along a Morton curve of 1024
// cells an axis. A point has three coordinates under [].
template <class Point>
std::vector<std::uint32_t> curve_order(const std::vector<Point>& points, double radius) {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> codes;
  codes.reserve(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    std::uint32_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double fraction = points[i][axis] / radius * 0.499 + 0.5;
      const auto cell = static_cast<std::uint32_t>(fraction * 1023);
      for (std::uint32_t bit = 0; bit < 10; ++bit) code |= ((cell >> bit) & 1u) << (3 * bit + axis);
    }
    codes.emplace_back(code, i);
  }
  std::sort(codes.begin(), codes.end());
  std::vector<std::uint32_t> order;
  order.reserve(points.size());
  for (const auto& code : codes) order.push_back(code.second);
  return order;
}

}  // namespace forcelayer::test

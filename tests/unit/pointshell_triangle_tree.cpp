// The nearest point of a triangle, however thin it is.
#include "pointshell/part/triangle_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

namespace forcelayer {
namespace {

using Wide = std::array<long double, 3>;

Wide wide(const part::Vec3& p) { return {p.x, p.y, p.z}; }

long double distance_to_segment(const Wide& p, const Wide& a, const Wide& b) {
  long double along = 0, squared = 0, result = 0;
  for (int d = 0; d < 3; ++d) {
    along += (p[d] - a[d]) * (b[d] - a[d]), squared += (b[d] - a[d]) * (b[d] - a[d]);
  }
  const long double t = squared > 0 ? std::clamp(along / squared, 0.0L, 1.0L) : 0.0L;
  for (int d = 0; d < 3; ++d) {
    const long double off = a[d] + t * (b[d] - a[d]) - p[d];
    result += off * off;
  }
  return std::sqrt(result);
}

// The twin: the least over segments across the triangle, found by ternary search, because the
// distance to a segment is a convex function of where the segment is.
long double slow_distance(const Wide& p, const Wide& a, const Wide& b, const Wide& c) {
  const auto across = [&](long double t) {
    Wide on_b = a, on_c = a;
    for (int d = 0; d < 3; ++d) on_b[d] += t * (b[d] - a[d]), on_c[d] += t * (c[d] - a[d]);
    return distance_to_segment(p, on_b, on_c);
  };
  long double low = 0, high = 1;
  for (int step = 0; step < 120; ++step) {
    const long double third = (high - low) / 3;
    if (across(low + third) < across(high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  return across((low + high) / 2);
}

TEST(NearestOnTriangle, IsNearestAlsoOnSlivers) {
  constexpr std::uint64_t kSeed = 12;
  std::mt19937_64 random(kSeed);
  std::uniform_real_distribution<double> unit(-1, 1), exponent(-18, 0);
  const auto place = [&](double scale) {
    const part::Vec3 p{unit(random), unit(random), unit(random)};
    return scale * p;
  };
  for (int n = 0; n < 20000; ++n) {
    const part::Vec3 a = place(1), along = place(1);
    const part::Vec3 off = place(std::pow(10, exponent(random)));
    const double way = unit(random);
    std::array<part::Vec3, 3> corners{a, a + along, a + way * along + off};
    if (n % 50 == 0) corners[2] = corners[n / 50 % 2];
    std::rotate(corners.begin(), corners.begin() + n % 3, corners.end());
    const double fraction = unit(random);
    const part::Vec3 p = a + fraction * along + place(n % 2 == 0 ? 1 : 0.01);
    const auto& [u, v, w] = corners;
    const double found = part::length(part::nearest_on_triangle(p, u, v, w) - p);
    const auto twin = static_cast<double>(slow_distance(wide(p), wide(u), wide(v), wide(w)));
    ASSERT_NEAR(found, twin, 1e-9) << "seed " << kSeed << ", triangle " << n;
  }
}

}  // namespace
}  // namespace forcelayer

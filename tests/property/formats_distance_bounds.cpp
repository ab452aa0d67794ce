// The bounds of voxmap_format.md, section 13, held against points and distances.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "formats/audit/layer_distance.h"
#include "formats/voxmap_format.h"
#include "tests/support/sanitized.h"

namespace forcelayer {
namespace {

using Point = std::array<double, 3>;

double distance(const Point& a, const Point& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

// The distance of `x` from the nearest center of the block of (2m + 1)^3 around the origin.
double distance_to_block(const Point& x, int m) {
  double squared = 0;
  for (const double coordinate : x) {
    const double o = coordinate - std::clamp(std::round(coordinate), -1.0 * m, 1.0 * m);
    squared += o * o;
  }
  return std::sqrt(squared);
}

// No point that is R from every center of the block is nearer to its middle than B(m), and one is
// as near: 13.2.
TEST(DistanceBounds, LayersImplyTheirDistance) {
  std::mt19937_64 random(1);
  // Radii of one to four layers, and of standoffs between them.
  for (const double more : {0.0, 0.11, 0.5, 1.0, 1.7, 2.0, 3.0}) {
    const double radius = kMinInteriorVoxels + more;
    for (int m = 0; m <= 5; ++m) {
      SCOPED_TRACE("radius " + std::to_string(radius) + " m " + std::to_string(m));
      const double bound = layer_distance_voxels(radius, m);
      std::uniform_real_distribution<double> along(-(m + radius + 1), m + radius + 1);
      double nearest = 1e9;
      for (int sample = 0; sample < (test::kSanitized ? 20000 : 200000); ++sample) {
        const Point x{along(random), along(random), along(random)};
        if (distance_to_block(x, m) >= radius) nearest = std::min(nearest, distance(x, {0, 0, 0}));
      }
      EXPECT_GE(nearest, bound);
      const double out = std::sqrt(radius * radius - 0.5);
      const Point extreme{m + out, 0.5, 0.5};
      EXPECT_NEAR(distance_to_block(extreme, m), radius, 1e-12);
      EXPECT_NEAR(distance(extreme, {0, 0, 0}), bound, 1e-12);
    }
  }
}

// The table of 13.3: what an interpolation in a free voxel keeps above the zero force.
TEST(DistanceBounds, InterpolationInFreeVoxelsStaysAboveTheZeroForce) {
  const auto margin = [](std::uint32_t k, int n) {
    const double radius = interior_radius_voxels(k);
    return (layer_distance_voxels(radius, n + 1) + 7 * layer_distance_voxels(radius, n)) / 8 -
           (radius + n);
  };
  const double table[4][4] = {{-0.090, -0.146, -0.186, -0.211},
                              {0.073, 0.051, 0.029, 0.011},
                              {0.100, 0.087, 0.073, 0.059},
                              {0.111, 0.102, 0.091, 0.081}};
  const double limits[4] = {-0.240, -0.014, 0.036, 0.060};
  for (std::uint32_t k = 1; k <= 4; ++k) {
    for (int column = 0; column < 4; ++column) {
      EXPECT_NEAR(margin(k, 1 << column), table[k - 1][column], 6e-4);  // printed to a thousandth
    }
    EXPECT_NEAR(margin(k, 1000000), limits[k - 1], 6e-4);
    for (int n = 1; n < 200; ++n) EXPECT_GT(margin(k, n), margin(k, n + 1));
  }
  EXPECT_GT(margin(2, 15), 0);
  EXPECT_LT(margin(2, 16), 0);
}

// The case that attains the bound: with M those points that see each center of the cell at its
// least, the middle voxel is free and the interpolation in its corner is the bound.
TEST(DistanceBounds, InterpolationAttainsItsBound) {
  for (const std::uint32_t k : {1u, 2u, 3u}) {
    for (const int n : {1, 2}) {
      const double radius = interior_radius_voxels(k), out = std::sqrt(radius * radius - 0.5);
      std::vector<Point> mesh;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const double u : {-0.5, 0.5, 1.5}) {
          for (const double v : {-0.5, 0.5, 1.5}) {
            Point x{};
            x[axis] = n + 1 + out;
            x[(axis + 1) % 3] = u;
            x[(axis + 2) % 3] = v;
            mesh.push_back(x);
          }
        }
      }
      for (const Point& x : mesh) EXPECT_GE(distance_to_block(x, n + 1), radius - 1e-12);
      double mean = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const Point center{1.0 * (corner & 1), 1.0 * (corner >> 1 & 1), 1.0 * (corner >> 2)};
        double nearest = 1e9;
        for (const Point& x : mesh) nearest = std::min(nearest, distance(x, center));
        mean += nearest / 8;
      }
      EXPECT_NEAR(mean,
                  (layer_distance_voxels(radius, n + 1) + 7 * layer_distance_voxels(radius, n)) / 8,
                  1e-12);
    }
  }
}

// 13.4: random sets of points, random places between eight centers, one of the bounds lowered.
TEST(DistanceBounds, EightCentersProveADistance) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> unit(0, 1), wide(-3, 4);
  double min_slack = 1e9;
  for (int trial = 0; trial < 20000; ++trial) {
    std::vector<Point> mesh(1 + random() % 6);
    for (Point& x : mesh) x = {wide(random), wide(random), wide(random)};
    const auto distance_of = [&](const Point& p) {
      double nearest = 1e9;
      for (const Point& x : mesh) nearest = std::min(nearest, distance(x, p));
      return nearest;
    };
    const Point p{unit(random), unit(random), unit(random)};
    double squared = 0;
    for (int corner = 0; corner < 8; ++corner) {
      double weight = 1;
      Point center{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        center[axis] = corner >> axis & 1;
        weight *= (corner >> axis & 1) ? p[axis] : 1 - p[axis];
      }
      const double lower = distance_of(center) - (random() % 4 == 0 ? unit(random) : 0);
      squared += weight * std::max(lower, 0.0) * std::max(lower, 0.0);
    }
    for (const double t : p) squared -= t * (1 - t);
    const double exact = distance_of(p);
    EXPECT_LE(squared, exact * exact + 1e-12);
    min_slack = std::min(min_slack, exact * exact - squared);
  }
  EXPECT_LT(min_slack, 1e-9);  // with one point the bound is the distance
}

}  // namespace
}  // namespace forcelayer

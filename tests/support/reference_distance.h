// Distances from triangles, slow and obviously right: of points by the cases of the nearest
// feature, of cubes by searching the triangle for the point that is nearest to the cube, which is a
// convex problem. And what Euclidean bakes are by them.
#pragma once

#include <cmath>

#include "tests/support/reference_bake.h"

namespace forcelayer::reference {

using Point = std::array<double, 3>;  // voxels

inline Point in_voxels(const LatticePoint& p) {
  constexpr double kUnit = static_cast<double>(kSnapUnits);
  return {static_cast<double>(p[0]) / kUnit, static_cast<double>(p[1]) / kUnit,
          static_cast<double>(p[2]) / kUnit};
}

inline Point between(const Point& a, const Point& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

// Of a point from the closed cube of a voxel.
inline double from_cube(const Point& p, const VoxelIndex& voxel) {
  double sum = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const auto low = static_cast<double>(voxel[d]);
    const double gap = std::max({0.0, low - p[d], p[d] - low - 1});
    sum += gap * gap;
  }
  return std::sqrt(sum);
}

// The least of a convex f over [0, 1], by golden sections down to 1e-14.
template <class F>
double least_of(F&& f) {
  constexpr double kShare = 0.6180339887498949;
  double low = 0, high = 1, a = 1 - kShare, b = kShare, at_a = f(a), at_b = f(b);
  for (int n = 0; n < 67; ++n) {
    if (at_a <= at_b) {
      high = b, b = a, at_b = at_a, a = high - kShare * (high - low), at_a = f(a);
    } else {
      low = a, a = b, at_a = at_b, b = low + kShare * (high - low), at_b = f(b);
    }
  }
  return std::min({at_a, at_b, f(0), f(1)});
}

// Of the closed cube of a voxel from a triangle, voxels.
inline double cube_distance(const LatticeTriangle& triangle, const VoxelIndex& voxel) {
  const Point a = in_voxels(triangle[0]), b = in_voxels(triangle[1]), c = in_voxels(triangle[2]);
  return least_of([&](double s) {
    const Point p = between(a, b, s), q = between(a, c, s);
    return least_of([&](double t) { return from_cube(between(p, q, t), voxel); });
  });
}

// Of a point from a triangle (Ericson, Real-Time Collision Detection, 5.1.5), voxels.
inline double point_distance(const LatticeTriangle& triangle, const Point& p) {
  const Point a = in_voxels(triangle[0]), b = in_voxels(triangle[1]), c = in_voxels(triangle[2]);
  const auto minus = [](const Point& x, const Point& y) {
    return Point{x[0] - y[0], x[1] - y[1], x[2] - y[2]};
  };
  const auto dot = [](const Point& x, const Point& y) {
    return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
  };
  const auto from_edge = [&](const Point& from, const Point& to) {
    const Point e = minus(to, from), w = minus(p, from);
    const double length2 = dot(e, e);
    const double t = length2 > 0 ? std::clamp(dot(w, e) / length2, 0.0, 1.0) : 0;
    const Point away = minus(p, between(from, to, t));
    return std::sqrt(dot(away, away));
  };
  double least = std::min({from_edge(a, b), from_edge(b, c), from_edge(c, a)});
  const Point u = minus(b, a), v = minus(c, a), w = minus(p, a);
  const Point n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const double n2 = dot(n, n);
  if (n2 == 0) return least;
  const auto cross_dot = [&](const Point& x, const Point& y) {
    return n[0] * (x[1] * y[2] - x[2] * y[1]) + n[1] * (x[2] * y[0] - x[0] * y[2]) +
           n[2] * (x[0] * y[1] - x[1] * y[0]);
  };
  const double s = cross_dot(w, v) / n2, t = cross_dot(u, w) / n2;
  if (s >= 0 && t >= 0 && s + t <= 1) least = std::min(least, std::abs(dot(n, w)) / std::sqrt(n2));
  return least;
}

inline Point center_of(const VoxelIndex& v) {
  return {static_cast<double>(v[0]) + 0.5, static_cast<double>(v[1]) + 0.5,
          static_cast<double>(v[2]) + 0.5};
}

// Whether the closed cube is less than `radius` from the triangle. Distances of lattice points that
// differ from the radius by less than 1e-9 are equal to it.
inline bool is_near(const LatticeTriangle& triangle, const VoxelIndex& voxel, double radius) {
  const double center = point_distance(triangle, center_of(voxel));
  if (center < radius + 0.499) return true;
  if (center > radius + 0.8661) return false;
  return cube_distance(triangle, voxel) < radius - 1e-9;
}

// The value of every voxel with Euclidean layers (voxmap_format.md, section 5): interior where I,
// or where the closed cube is less than k - 1 voxels from the surface or passed through by it;
// surface, then proximity next to that, corners included. The margin must be above layers + 1.
inline DenseGrid euclidean_scene(const std::vector<LatticeMesh>& meshes,
                                 const ReferenceScene& scene, int layers) {
  DenseGrid values(scene.geometry.low(), scene.geometry.high());
  values.for_each([&](const VoxelIndex& v) {
    if (scene.geometry.at(v) == 1 || scene.interior.at(v) == 1) values.at(v) = 1;
  });
  for (const LatticeMesh& mesh : meshes) {
    for (const LatticeTriangle& triangle : mesh) {
      VoxelIndex low, high;
      for (std::size_t d = 0; d < 3; ++d) {
        const auto [least, most] = std::minmax({triangle[0][d], triangle[1][d], triangle[2][d]});
        low[d] = (least >> kSnapBits) - layers;
        high[d] = (most >> kSnapBits) + layers;
      }
      DenseGrid(low, high).for_each([&](const VoxelIndex& v) {
        if (layers > 1 && values.at(v) == 0 && is_near(triangle, v, layers - 1)) values.at(v) = 1;
      });
    }
  }
  for (const auto value : {VoxelValue::kSurface, VoxelValue::kProximity}) {
    const DenseGrid inner = values;
    inner.for_each([&](const VoxelIndex& g) {
      if (inner.at(g) == 0) return;
      for (int n = 0; n < 27; ++n) {
        const VoxelIndex v{g[0] + n / 9 - 1, g[1] + n / 3 % 3 - 1, g[2] + n % 3 - 1};
        if (values.at(v) == 0) values.at(v) = static_cast<std::uint8_t>(value);
      }
    });
  }
  return values;
}

}  // namespace forcelayer::reference

// Distances of points from triangles, slow and obviously right, by the cases of the nearest
// feature. And what Euclidean bakes are by them.
#pragma once

#include <cmath>

#include "tests/support/reference_bake.h"

namespace forcelayer::reference {

using Point = std::array<double, 3>;  // voxels

inline Point in_voxels(const lattice::LatticePoint& p) {
  constexpr double kUnit = static_cast<double>(lattice::kSnapUnits);
  return {static_cast<double>(p[0]) / kUnit, static_cast<double>(p[1]) / kUnit,
          static_cast<double>(p[2]) / kUnit};
}

inline Point between(const Point& a, const Point& b, double t) {
  return {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};
}

// The distance of a point from a triangle (Ericson, Real-Time Collision Detection, 5.1.5), voxels.
inline double point_distance(const lattice::LatticeTriangle& triangle, const Point& p) {
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
  double smallest = std::min({from_edge(a, b), from_edge(b, c), from_edge(c, a)});
  const Point u = minus(b, a), v = minus(c, a), w = minus(p, a);
  const Point n{u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
  const double n2 = dot(n, n);
  if (n2 == 0) return smallest;
  const auto cross_dot = [&](const Point& x, const Point& y) {
    return n[0] * (x[1] * y[2] - x[2] * y[1]) + n[1] * (x[2] * y[0] - x[0] * y[2]) +
           n[2] * (x[0] * y[1] - x[1] * y[0]);
  };
  const double s = cross_dot(w, v) / n2, t = cross_dot(u, w) / n2;
  if (s >= 0 && t >= 0 && s + t <= 1)
    smallest = std::min(smallest, std::abs(dot(n, w)) / std::sqrt(n2));
  return smallest;
}

inline Point center_of(const lattice::VoxelIndex& v) {
  return {static_cast<double>(v[0]) + 0.5, static_cast<double>(v[1]) + 0.5,
          static_cast<double>(v[2]) + 0.5};
}

// The centers of the interior's voxels are nearer than this to the surface, voxels: k - 1, half a
// diagonal, and up to the second multiple of 2^-10 above.
inline double interior_radius(int layers) { return layers - 1 + 888.0 / 1024.0; }

// Whether the center is less than `radius` from the triangle. Distances of lattice points that
// differ from the radius by less than 1e-9 are equal to it.
inline bool is_near(const lattice::LatticeTriangle& triangle, const lattice::VoxelIndex& voxel,
                    double radius) {
  return point_distance(triangle, center_of(voxel)) < radius - 1e-9;
}

// The value of every voxel with Euclidean layers (voxmap_format.md, section 5): interior where I,
// or where the center is less than interior_radius() from the surface; surface, then proximity next
// to that, corners included. The margin must be above layers + 2.
inline DenseGrid euclidean_scene(const std::vector<LatticeMesh>& meshes,
                                 const ReferenceScene& scene, int layers) {
  DenseGrid values(scene.geometry.low(), scene.geometry.high());
  values.for_each([&](const lattice::VoxelIndex& v) {
    if (scene.interior.at(v) == 1) values.at(v) = 1;
  });
  for (const LatticeMesh& mesh : meshes) {
    for (const lattice::LatticeTriangle& triangle : mesh) {
      lattice::VoxelIndex low, high;
      for (std::size_t d = 0; d < 3; ++d) {
        const auto [smallest, largest] =
            std::minmax({triangle[0][d], triangle[1][d], triangle[2][d]});
        low[d] = (smallest >> lattice::kSnapBits) - layers;
        high[d] = (largest >> lattice::kSnapBits) + layers;
      }
      DenseGrid(low, high).for_each([&](const lattice::VoxelIndex& v) {
        if (values.at(v) == 0 && is_near(triangle, v, interior_radius(layers))) values.at(v) = 1;
      });
    }
  }
  for (const auto value : {VoxelValue::kSurface, VoxelValue::kProximity}) {
    const DenseGrid inner = values;
    inner.for_each([&](const lattice::VoxelIndex& g) {
      if (inner.at(g) == 0) return;
      for (int n = 0; n < 27; ++n) {
        const lattice::VoxelIndex v{g[0] + n / 9 - 1, g[1] + n / 3 % 3 - 1, g[2] + n % 3 - 1};
        if (values.at(v) == 0) values.at(v) = static_cast<std::uint8_t>(value);
      }
    });
  }
  return values;
}

}  // namespace forcelayer::reference

// Scenes and parts for tests of motion, from signed distances instead of meshes.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "tests/support/point_part.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {

// Signed distance to a solid, m: negative inside.
using SignedDistance = std::function<double(const glm::dvec3&)>;

// Grows every marked voxel by one step in all 26 directions: three passes, one per axis.
inline std::vector<std::uint8_t> grown(const std::vector<std::uint8_t>& marked, const Voxel& dims) {
  std::vector<std::uint8_t> grown = marked;
  const std::array<std::int64_t, 3> stride{dims[1] * dims[2], dims[2], 1};
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<std::uint8_t> before = grown;
    for (std::int64_t i = 0; i < dims[0]; ++i)
      for (std::int64_t j = 0; j < dims[1]; ++j)
        for (std::int64_t k = 0; k < dims[2]; ++k) {
          const std::int64_t at = i * stride[0] + j * stride[1] + k;
          const std::int64_t along = axis == 0 ? i : axis == 1 ? j : k;
          const auto s = stride[static_cast<std::size_t>(axis)];
          if (along > 0 && before[static_cast<std::size_t>(at - s)])
            grown[static_cast<std::size_t>(at)] = 1;
          if (along + 1 < dims[static_cast<std::size_t>(axis)] &&
              before[static_cast<std::size_t>(at + s)])
            grown[static_cast<std::size_t>(at)] = 1;
        }
  }
  return grown;
}

// The scene of a solid, k offset layers. A voxel is part of the solid where the distance at its
// center is at most half the voxel's extent along the distance's gradient: exact for planes, and
// at least the voxels that the solid touches elsewhere to first order.
inline VoxelScene shape_scene(double voxel_size_m, const Voxel& min, const Voxel& dims,
                              const SignedDistance& distance_m, std::uint32_t k = 2) {
  const double s = voxel_size_m, e = 1e-4 * s;
  const auto solid = [&](const Voxel& v) {
    const glm::dvec3 p = s * (glm::dvec3(v[0], v[1], v[2]) + 0.5);
    const double d = distance_m(p);
    if (d > s || d <= 0) return d <= 0;
    double extent = 0;  // |gradient|_1 / 2
    for (int axis = 0; axis < 3; ++axis) {
      glm::dvec3 step(0);
      step[axis] = e;
      extent += std::abs(distance_m(p + step) - distance_m(p - step)) / (4 * e);
    }
    return d <= s * extent;
  };
  VoxelScene scene = VoxelScene::filled(voxel_size_m, min, dims, [&](const Voxel& v) {
    return solid(v) ? VoxelValue::kInterior : VoxelValue::kFree;
  });
  scene.layers = k;
  std::vector<std::uint8_t> marked = scene.values;
  for (std::uint32_t layer = 1; layer <= k + 1; ++layer) {
    marked = grown(marked, dims);
    const VoxelValue value = layer < k    ? VoxelValue::kInterior
                             : layer == k ? VoxelValue::kSurface
                                          : VoxelValue::kProximity;
    for (std::size_t i = 0; i < marked.size(); ++i) {
      if (marked[i] && scene.values[i] == 0) scene.values[i] = static_cast<std::uint8_t>(value);
    }
  }
  return scene;
}

// A box of the given half extents (m), points at most `spacing_m` apart on a lattice over each
// face, inertia of the solid.
inline PointPart box_part(const glm::dvec3& half_m, double spacing_m, double voxel_size_m) {
  PointPart part;
  part.voxel_size_m = voxel_size_m;
  part.covering_radius_m = spacing_m / std::sqrt(2.0);
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const auto steps = [&](int along) {
      return std::max(1, static_cast<int>(std::ceil(2 * half_m[along] / spacing_m)));
    };
    for (const double side : {-1.0, 1.0})
      for (int i = 0; i <= steps(a); ++i)
        for (int j = 0; j <= steps(b); ++j) {
          glm::dvec3 p(0), n(0);
          p[axis] = side * half_m[axis];
          p[a] = half_m[a] * (2.0 * i / steps(a) - 1);
          p[b] = half_m[b] * (2.0 * j / steps(b) - 1);
          n[axis] = -side;
          part.add({p.x, p.y, p.z}, {n.x, n.y, n.z});
        }
  }
  const glm::dvec3 q = half_m * half_m / 3.0;
  part.inertia_m2 = {q.y + q.z, q.x + q.z, q.x + q.y, 0, 0, 0};
  return part;
}

}  // namespace forcelayer::test

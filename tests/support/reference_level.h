// Slow twins of the level field (runtime/field/level_field.h). `float_push` follows its arithmetic
// word by word on the dense scene, without tree or vectors; `exact_levels` is its definition as a
// weighted sum over 27 voxels, in double precision.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>

#include "runtime/query/contact_query.h"
#include "tests/support/voxel_scene.h"

namespace forcelayer::test {

// The level of a world voxel; beyond the sides in `cropped_sides` that of the nearest known voxel.
inline int level_of(const VoxelScene& scene, Voxel v, std::uint32_t cropped_sides = 0) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t low = scene.min[axis], high = low + scene.dims[axis] - 1;
    if (cropped_sides >> (2 * axis) & 1) v[axis] = std::max(v[axis], low);
    if (cropped_sides >> (2 * axis + 1) & 1) v[axis] = std::min(v[axis], high);
  }
  switch (scene.at(v)) {
    case VoxelValue::kInterior:
      return -1;
    case VoxelValue::kSurface:
      return 0;
    case VoxelValue::kProximity:
      return 1;
    default:
      return 2;
  }
}

struct TwinPush {
  float phi = 0;      // voxels
  float depth_m = 0;  // signed: negative in front of where the push begins
  std::array<float, 3> direction{}, slope{};
};

namespace detail {

// a + fraction * (b - a), the product rounded to the nearest, `fraction` in 2^-15.
inline int mix(int a, int b, int fraction) { return a + (((b - a) * fraction + 0x4000) >> 15); }

// Trilinear between eight corners (4 x + 2 y + z): y and x in integers of 1/1024, z in floats.
inline float trilinear(const std::array<int, 8>& c, const std::array<float, 3>& f) {
  const int x = static_cast<int>(f[0] * 32768.0f), y = static_cast<int>(f[1] * 32768.0f);
  std::array<float, 2> at_z{};
  for (std::size_t z = 0; z < 2; ++z) {
    const int low = mix(1024 * c[z], 1024 * c[2 + z], y);
    const int high = mix(1024 * c[4 + z], 1024 * c[6 + z], y);
    at_z[z] = static_cast<float>(mix(low, high, x)) * (1.0f / 1024);
  }
  return at_z[0] + f[2] * (at_z[1] - at_z[0]);
}

}  // namespace detail

// The definition of ForceField::measure at `fraction` of a world voxel.
inline TwinPush float_push(const VoxelScene& scene, const Voxel& voxel,
                           const std::array<float, 3>& fraction, const std::array<float, 3>& n,
                           std::uint32_t cropped_sides = 0) {
  std::array<int, 8> level{}, dx{}, dy{}, dz{};
  for (int c = 0; c < 8; ++c) {
    for (int v = 0; v < 8; ++v) {
      const Voxel at{voxel[0] - 1 + (c >> 2) + (v >> 2), voxel[1] - 1 + (c >> 1 & 1) + (v >> 1 & 1),
                     voxel[2] - 1 + (c & 1) + (v & 1)};
      const int l = level_of(scene, at, cropped_sides);
      level[c] += l + 1;  // raised: none is negative
      dx[c] += v & 4 ? l : -l;
      dy[c] += v & 2 ? l : -l;
      dz[c] += v & 1 ? l : -l;
    }
  }
  const auto voxel_size_m = static_cast<float>(scene.voxel_size_m);
  TwinPush twin;
  twin.phi = detail::trilinear(level, fraction) * 0.125f - 1.0f;
  const float gx = detail::trilinear(dx, fraction) * 0.25f;
  const float gy = detail::trilinear(dy, fraction) * 0.25f;
  const float gz = detail::trilinear(dz, fraction) * 0.25f;

  twin.slope = {gx, gy, gz};
  const float along = gx * n[0] + gy * n[1] + gz * n[2];
  const float steepness2 = gx * gx + gy * gy + gz * gz;
  const float agreement = 16.0f * (along * std::abs(along) - 0.5625f * steepness2);
  const float t = std::min(std::max(agreement, 0.0f), 1.0f);
  const float w = t * t * (3.0f - 2.0f * t);
  const float h = std::min(std::max((-0.5f - twin.phi) * 4.0f, 0.0f), 1.0f);
  const float on_n = w + 0.05f * h, on_g = 1.0f - w;
  const std::array<float, 3> u{on_n * n[0] + on_g * gx, on_n * n[1] + on_g * gy,
                               on_n * n[2] + on_g * gz};
  const float length = std::sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
  if (!(length > 1e-6f)) {
    twin.depth_m = twin.phi < 0.0f ? 0.0f : -twin.phi * voxel_size_m;
    twin.direction = n;
    return twin;
  }
  const float per_length = 1.0f / length;
  for (std::size_t axis = 0; axis < 3; ++axis) twin.direction[axis] = u[axis] * per_length;
  const auto& d = twin.direction;
  const float strength = std::min(length * 10.0f, 1.0f);
  const bool euclidean = scene.metric == Metric::kEuclidean;
  const float a = euclidean ? 0.8660254f : 0.0f, b = euclidean ? 0.5f : 0.0f;
  const float norm1 = std::abs(d[0]) + std::abs(d[1]) + std::abs(d[2]);
  twin.depth_m = -(twin.phi + b) * strength * voxel_size_m * norm1 + a * strength * voxel_size_m;
  return twin;
}

struct ExactLevels {
  double phi = 0;
  glm::dvec3 slope{0, 0, 0};
};

// phi is the levels' sum with the trapezoid (1-f, 1, f) / 2 per axis; its slope along an axis has
// the differences of neighbors, (f-1, 1-2f, f), on that axis in their place.
inline ExactLevels exact_levels(const VoxelScene& scene, const Voxel& voxel,
                                const std::array<float, 3>& fraction) {
  std::array<std::array<double, 3>, 3> value{}, difference{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double f = fraction[axis];
    value[axis] = {(1 - f) / 2, 0.5, f / 2};
    difference[axis] = {f - 1, 1 - 2 * f, f};
  }
  ExactLevels sum;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j)
      for (std::size_t k = 0; k < 3; ++k) {
        const double level = level_of(scene, {voxel[0] + static_cast<std::int64_t>(i) - 1,
                                              voxel[1] + static_cast<std::int64_t>(j) - 1,
                                              voxel[2] + static_cast<std::int64_t>(k) - 1});
        sum.phi += level * value[0][i] * value[1][j] * value[2][k];
        sum.slope.x += level * difference[0][i] * value[1][j] * value[2][k];
        sum.slope.y += level * value[0][i] * difference[1][j] * value[2][k];
        sum.slope.z += level * value[0][i] * value[1][j] * difference[2][k];
      }
  return sum;
}

// Appends a point to `points` as the contact query would leave it, whatever its voxel's value.
inline void collect(query::CollectedPoints& points, const Voxmap& voxmap, const Voxel& voxel,
                    VoxelValue value, const std::array<float, 3>& fraction,
                    const std::array<float, 3>& normal) {
  const std::uint32_t at = points.count++;
  const auto& origin = voxmap.header().directory_origin;
  points.index[at] = at;
  points.value[at] = static_cast<std::uint8_t>(value);
  points.interior_count += value == VoxelValue::kInterior;
  points.surface_count += value == VoxelValue::kSurface;
  points.proximity_count += value == VoxelValue::kProximity;
  points.vx[at] = static_cast<std::int32_t>(voxel[0] - origin[0]);
  points.vy[at] = static_cast<std::int32_t>(voxel[1] - origin[1]);
  points.vz[at] = static_cast<std::int32_t>(voxel[2] - origin[2]);
  points.fx[at] = fraction[0], points.fy[at] = fraction[1], points.fz[at] = fraction[2];
  points.nx[at] = normal[0], points.ny[at] = normal[1], points.nz[at] = normal[2];
}

}  // namespace forcelayer::test

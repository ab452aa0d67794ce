// Scenes of 4 and 8 bits from signed distances instead of meshes, by the definition of
// voxmap_format.md, section 6. Nothing of voxelize is used here.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/vec3.hpp>

#include "tests/support/voxel_scene.h"

namespace forcelayer::test {

// The definition, in doubles and voxels.
struct DistanceDefinition {
  std::uint32_t bits = 8;
  double range = 4, quantum = 0;
  double interior = 0, zero = 0, surface = 0, proximity = 0;  // values by distance
  std::uint32_t zero_code = 0, surface_code = 0, proximity_code = 0, free_code = 0;

  // `layer_voxels`: how deep the force layer is, more than 1 under a soft covering.
  DistanceDefinition(std::uint32_t k, std::uint32_t bits_per_voxel, double range_voxels,
                     double layer_voxels = 1)
      : bits(bits_per_voxel), range(range_voxels) {
    interior = k - 1 + std::sqrt(3.0) / 2 + 1e-3;
    zero = interior + layer_voxels;
    free_code = (1u << bits) - 1;
    const double reach = (3 + 3 * std::sqrt(2.0) + std::sqrt(3.0)) / 8;
    for (zero_code = free_code; zero_code > 0; --zero_code) {
      quantum = range / zero_code;
      const double t = reach + quantum, kept = bits == 8 ? t + std::sqrt(3.0) : t + quantum;
      if (zero_code + std::ceil(kept / quantum) > free_code) continue;
      surface = zero + t;
      proximity = surface + std::sqrt(3.0);
      proximity_code = zero_code + static_cast<std::uint32_t>(std::ceil(t / quantum));
      surface_code = zero_code - static_cast<std::uint32_t>(std::lround(layer_voxels / quantum));
      break;
    }
  }

  std::uint32_t code(double distance) const {
    const double steps = (distance - zero) / quantum + zero_code;
    const auto nearest = static_cast<std::int64_t>(std::llround(std::clamp(steps, 0.0, 1e6)));
    const auto between = [&](std::uint32_t low, std::uint32_t high) {
      return static_cast<std::uint32_t>(
          std::clamp<std::int64_t>(nearest, std::int64_t{low}, std::int64_t{high}));
    };
    if (distance < interior) return between(0, surface_code - 1);
    if (distance < surface) return between(surface_code, proximity_code - 1);
    if (distance < proximity) return between(proximity_code, free_code - 1);
    return free_code;
  }

  VoxelValue value(std::uint32_t code) const {
    if (code < surface_code) return VoxelValue::kInterior;
    if (code < proximity_code) return VoxelValue::kSurface;
    return code < free_code ? VoxelValue::kProximity : VoxelValue::kFree;
  }
};

// The scene of a solid whose signed distance (m, negative inside) is given.
inline VoxelScene distance_scene(double voxel_size_m, const Voxel& min, const Voxel& dims,
                                 const std::function<double(const glm::dvec3&)>& distance_m,
                                 std::uint32_t k, const DistanceDefinition& definition) {
  VoxelScene scene;
  scene.voxel_size_m = voxel_size_m;
  scene.min = min;
  scene.dims = dims;
  scene.layers = k;
  scene.wide = {
      definition.bits,      definition.range * voxel_size_m, definition.quantum * voxel_size_m,
      definition.zero_code, definition.surface_code,         definition.proximity_code,
      definition.free_code};
  scene.values = VoxelScene::filled(voxel_size_m, min, dims, [&](const Voxel& v) {
                   const glm::dvec3 p = voxel_size_m * (glm::dvec3(v[0], v[1], v[2]) + 0.5);
                   const std::uint32_t code = definition.code(distance_m(p) / voxel_size_m);
                   scene.codes.push_back(static_cast<std::uint8_t>(code));
                   return definition.value(code);
                 }).values;
  return scene;
}

}  // namespace forcelayer::test

// Scenes with stored distances from signed distances instead of meshes, by the definition of
// voxmap_format.md, sections 5 and 6. Nothing of voxelize is used here.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/vec3.hpp>

#include "tests/support/voxel_scene.h"

namespace forcelayer::test {

// The definition, in doubles and voxels.
struct DistanceDefinition {
  double interior = 0, zero_force = 0, force_depth = 0, range = 0, quantum = 0;
  std::int32_t zero_code = 0;
  std::int64_t force_layers = 1;

  // `depth_voxels`: how deep the force layer is, more than 1 under a soft covering.
  explicit DistanceDefinition(std::uint32_t k, double range_voxels = 4, double depth_voxels = 1)
      : interior(k - 1 + 888.0 / 1024),
        zero_force(interior + depth_voxels),
        force_depth(depth_voxels),
        range(std::max(range_voxels, zero_force)),
        quantum((range + 3) / 253),
        zero_code(1 - static_cast<std::int32_t>(std::floor((zero_force - range) / quantum))),
        force_layers(static_cast<std::int64_t>(std::ceil(depth_voxels - 1e-9))) {}

  // Rounded down, as a writer must; it may err by a thousandth of a voxel more.
  std::uint32_t code(double distance) const {
    return static_cast<std::uint32_t>(
        std::clamp(std::floor(distance / quantum) + zero_code, 0.0, 255.0));
  }
};

// The scene of a solid whose signed distance (m, negative inside) is given.
inline VoxelScene distance_scene(double voxel_size_m, const Voxel& min, const Voxel& dims,
                                 const std::function<double(const glm::dvec3&)>& distance_m,
                                 std::uint32_t k, const DistanceDefinition& definition) {
  const auto distance = [&](const Voxel& v) {
    return distance_m(voxel_size_m * (glm::dvec3(v[0], v[1], v[2]) + 0.5)) / voxel_size_m;
  };
  // The layers are Chebyshev layers around the interior.
  VoxelScene scene =
      offset_scene(voxel_size_m, min, dims, 1, definition.force_layers,
                   [&](const Voxel& v) { return distance(v) < definition.interior; });
  scene.layers = k;
  scene.metric = Metric::kEuclidean;
  scene.zero_force_voxels = definition.zero_force;
  scene.force_depth_voxels = definition.force_depth;
  scene.distances = {definition.quantum * voxel_size_m, definition.zero_code};
  VoxelScene::filled(voxel_size_m, min, dims, [&](const Voxel& v) {
    scene.codes.push_back(static_cast<std::uint8_t>(definition.code(distance(v))));
    return VoxelValue::kFree;
  });
  return scene;
}

}  // namespace forcelayer::test

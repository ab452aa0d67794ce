// Distances that layers of voxels imply (voxmap_format.md, section 13.2).
#pragma once

#include <cmath>
#include <cstdint>

namespace forcelayer {

// Where the Euclidean interior of k layers ends, from the mesh, in voxels.
inline double interior_radius_voxels(std::uint32_t layers) {
  return static_cast<double>(layers) - 1 + 888.0 / 1024;
}

// The least distance from the mesh of a voxel's center, in voxels, where no voxel within `steps`
// of it is interior; `layers` at least 1.
inline double layer_distance_voxels(std::uint32_t layers, double steps) {
  const double radius = interior_radius_voxels(layers);
  return std::sqrt(steps * steps + radius * radius + 2 * steps * std::sqrt(radius * radius - 0.5));
}

// The largest distance that it can have where one within `steps` of it is interior.
inline double most_layer_distance_voxels(std::uint32_t layers, double steps) {
  return interior_radius_voxels(layers) + steps * std::sqrt(3.0);
}

}  // namespace forcelayer

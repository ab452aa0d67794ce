// Distances that layers of voxels imply (voxmap_format.md, section 13.2).
#pragma once

#include <cmath>

namespace forcelayer {

// The least distance of a voxel's center from the mesh, in voxels, if no voxel within `steps` of it
// (Chebyshev) is interior. The interior ends at the distance `radius_voxels` from the mesh, which
// is kMinInteriorVoxels or more.
inline double layer_distance_voxels(double radius_voxels, double steps) {
  const double squared = radius_voxels * radius_voxels;
  return std::sqrt(steps * steps + squared + 2 * steps * std::sqrt(squared - 0.5));
}

// The largest distance of a voxel's center from the mesh if a voxel within `steps` of it is
// interior.
inline double max_layer_distance_voxels(double radius_voxels, double steps) {
  return radius_voxels + steps * std::sqrt(3.0);
}

}  // namespace forcelayer

// --roi: which voxels of the scene a bake keeps, and on which sides it crops the scene.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "voxelize/masks/voxel_box.h"

namespace forcelayer::limits {

struct Region {
  masks::VoxelBox box;              // the file's valid box
  std::uint32_t cropped_sides = 0;  // CroppedSide bits: the scene goes on beyond them
};

// The region of a bake. `scene` is the box of all voxels that are not free, and not empty. Without
// `roi_m` the region is the whole scene. With it (x0, y0, z0, x1, y1, z1 in meters) the region is
// the voxels that it touches, cut off where the scene ends. A `roi_m` beside the scene gives its
// own layer of voxels nearest to the scene.
Region region_of(const masks::VoxelBox& scene, const std::optional<std::array<double, 6>>& roi_m,
                 double voxel_size_m);

}  // namespace forcelayer::limits

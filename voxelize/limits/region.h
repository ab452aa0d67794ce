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

// `scene` is the box of all voxels that are not free; it is not empty. The region is all of it, or
// the voxels that `roi_m` (x0, y0, z0, x1, y1, z1 in meters) touches, cut off where the scene ends.
// A region beside the scene is the layer of it that lies nearest to the scene.
Region region_of(const masks::VoxelBox& scene, const std::optional<std::array<double, 6>>& roi_m,
                 double voxel_size_m);

}  // namespace forcelayer::limits

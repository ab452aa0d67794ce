// A region of interest: which voxels of the scene a bake keeps, and on which sides it cuts it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "voxelize/masks/voxel_box.h"

namespace forcelayer {

struct Region {
  VoxelBox box;                     // the file's valid box
  std::uint32_t cropped_sides = 0;  // CroppedSide bits: the scene goes on beyond them
};

// `scene` is the box of all voxels that are not free (not empty). Without `roi_m` all of it; else
// the voxels that the box touches (x0, y0, z0, x1, y1, z1 in metres), which ends where the scene
// does, or where a region beside the scene comes nearest to it.
Region region_of(const VoxelBox& scene, const std::optional<std::array<double, 6>>& roi_m,
                 double voxel_size_m);

}  // namespace forcelayer

// The .vox format's limits, checked before a bake takes any memory.
#pragma once

#include <array>
#include <cstdint>

#include "formats/result.h"
#include "voxelize/masks/voxel_box.h"

namespace forcelayer::limits {

// The directory over a box of voxels: cells of 512^3 voxels.
struct Directory {
  lattice::VoxelIndex origin{};         // lowest voxel, a multiple of 512
  std::array<std::uint32_t, 3> dims{};  // cells

  bool empty() const { return dims[0] == 0; }
};

// The directory over `box`, which is not empty. Error kBakeTooLarge, with the numbers and a voxel
// size that fits, where the directory would have more than 2^28 entries or 2^21 on an axis.
Result<Directory> fit_directory(const masks::VoxelBox& box, double voxel_size_m);

}  // namespace forcelayer::limits

// The box of a tree: clearance near its cropped sides, and the tight box of voxels that are not
// free.
#pragma once

#include <array>
#include <cstdint>

#include "voxelize/masks/voxel_box.h"
#include "voxelize/tree/built_tree.h"
#include "voxelize/tree/sharing.h"

namespace forcelayer::tree {

// Lowers clearances to the distance of the nearest cropped side, beyond which nothing is known: 0
// for entries that reach beyond one.
void clip_clearance(BuiltTree& tree, const masks::KeptBox& kept);

// The smallest box of all voxels that are not free, counted from the scene's origin; empty if all
// voxels are free.
masks::VoxelBox tight_box(const VoxelTree& tree,
                          const std::array<std::uint32_t, 3>& directory_dims);

}  // namespace forcelayer::tree

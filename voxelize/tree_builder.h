// The 512-tree of paper 4.3 in the layout of a .vox file.
#pragma once

#include <array>
#include <cstdint>

#include "voxelize/mask_tree.h"
#include "voxelize/offset.h"
#include "voxelize/sharing.h"

namespace forcelayer {

// The offset scene as a tree over `directory_dims` blocks of 512^3 voxels from the scene's origin.
// Uniform boxes are collapsed, equal bricks and equal nodes stored once, and numbers follow the
// order of the tree, so that the arrays depend on the voxels alone.
VoxelTree build_tree(const LayerOffset& offset, const MaskTree& interior,
                     const std::array<std::uint32_t, 3>& directory_dims, ValueCounts& counts);

}  // namespace forcelayer

// The 512-tree of paper 4.3 in the layout of a .vox file.
#pragma once

#include <array>
#include <cstdint>

#include "voxelize/mask_tree.h"
#include "voxelize/node_memory.h"
#include "voxelize/offset.h"
#include "voxelize/sharing.h"

namespace forcelayer {

// The offset scene as a tree over `directory_dims` blocks of 512^3 voxels from the scene's origin.
// Uniform boxes are collapsed, equal bricks and equal nodes stored once, and numbers follow the
// order of the tree, so that the arrays depend on the voxels alone. With a `memory` (may be null;
// nothing may be cropped then) nodes that did not change are taken from it, and it remembers this
// tree.
VoxelTree build_tree(const LayerOffset& offset, const std::array<std::uint32_t, 3>& directory_dims,
                     const NodeMemory* memory, ValueCounts& counts);

}  // namespace forcelayer

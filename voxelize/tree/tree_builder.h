// The 512-tree of paper 4.3 in the layout of a .vox file.
#pragma once

#include <array>
#include <cstdint>

#include "voxelize/cache/node_memory.h"
#include "voxelize/distance/distance_nodes.h"
#include "voxelize/distance/offset.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/tree/sharing.h"

namespace forcelayer {

// The offset scene as a tree over `directory_dims` blocks of 512^3 voxels from the scene's origin.
// Uniform boxes are collapsed, equal bricks and equal nodes stored once, and numbers follow the
// order of the tree, so that the arrays depend on the voxels alone. With a `memory` (may be null;
// nothing may be cropped then) nodes that did not change are taken from it, and it remembers this
// tree.
VoxelTree build_tree(const LayerOffset& offset, const std::array<std::uint32_t, 3>& directory_dims,
                     const NodeMemory* memory, ValueCounts& counts);

// The same of wider voxels, from the nodes of `around`: its layers are one less than the voxels
// around the geometry that matter. Uniform entries read as at two bits (see DistanceNodes::node);
// name_codes() gives them the codes of the file.
VoxelTree build_distance_tree(const LayerOffset& around, const DistanceNodes& distances,
                              const std::array<std::uint32_t, 3>& directory_dims,
                              ValueCounts& counts);
void name_codes(VoxelTree& tree, const DistanceScale& scale);

}  // namespace forcelayer

// The 512-tree of paper 4.3 in the layout of a .vox file.
#pragma once

#include <array>
#include <cstdint>
#include <functional>

#include "voxelize/distance/distance_codes.h"
#include "voxelize/distance/layer_offset.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/tree/distance_memory.h"
#include "voxelize/tree/node_memory.h"
#include "voxelize/tree/sharing.h"

namespace forcelayer::tree {

// Receives the fraction of the nodes that are done, by one thread at a time; may be empty.
using NodeProgress = std::function<void(double fraction_done)>;

// The offset scene as a tree over `directory_dims` directory cells from the scene's origin. Uniform
// boxes are collapsed, equal bricks and equal nodes stored once, and numbers follow the order of
// the tree, so that the arrays depend on the voxels alone. A `memory` (may be null; nothing may be
// cropped with one) supplies the nodes that did not change and keeps this tree.
VoxelTree build_tree(const distance::LayerOffset& offset,
                     const std::array<std::uint32_t, 3>& directory_dims, const NodeMemory* memory,
                     distance::ValueCounts& counts, const NodeProgress& progress = {});

// The trees of the distances' codes and of the objects' numbers over the same directory cells; that
// of the objects has nothing where the distances do not tell them apart. `around` lists the nodes:
// its layers and force layers together are DistanceCodes::reach(). Beside them, the surface grown.
// A `memory` (may be null) supplies the nodes that did not change and keeps these trees; it
// remembers no grown surface, so with it the surface must not grow here.
struct DistanceTrees {
  VoxelTree distances, objects;
  std::unique_ptr<masks::MaskTree> grown;  // null where the surface does not grow
};
DistanceTrees build_distance_trees(const distance::LayerOffset& around,
                                   const distance::DistanceCodes& distances,
                                   const std::array<std::uint32_t, 3>& directory_dims,
                                   const DistanceMemory* memory, const NodeProgress& progress = {});

}  // namespace forcelayer::tree

// Equal bricks and equal nodes stored once.
#pragma once

#include <cstdint>
#include <vector>

#include "voxelize/tree/built_tree.h"

namespace forcelayer::tree {

// The arrays of a .vox file.
struct VoxelTree {
  std::vector<std::uint32_t> directory;    // [dims x][dims y][dims z]
  std::vector<std::uint32_t> upper_nodes;  // [count][512]
  std::vector<std::uint32_t> lower_nodes;  // [count][512]
  std::vector<std::uint32_t> bricks;       // [count][16 * bits of an element]
};

// The tree with every different brick and node once, numbered by first use in the order of the
// tree: the arrays depend on the tree alone, not on threads. Frees the nodes as it goes.
// `lower_numbers` maps the tree's lower nodes to those of the result.
VoxelTree share_equal(BuiltTree&& built, std::vector<std::uint32_t>& lower_numbers);

}  // namespace forcelayer::tree

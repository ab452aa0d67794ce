// Sets of voxels between the stages of a bake: OpenVDB mask trees in the shape of the 512-tree.
//
// Voxels are counted from the scene's origin, a multiple of 512 voxels on each axis. An active tile
// is a uniform box of the set. A leaf's 512 bits are eight words as in BrickMask.
#pragma once

#include <openvdb/tree/InternalNode.h>
#include <openvdb/tree/LeafNodeMask.h>
#include <openvdb/tree/RootNode.h>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "formats/lattice/voxel_overlap.h"

namespace forcelayer::masks {

using MaskLeaf = openvdb::tree::LeafNode<openvdb::ValueMask, 3>;      // 8^3 voxels: a brick
using LowerMaskNode = openvdb::tree::InternalNode<MaskLeaf, 3>;       // 64^3 voxels
using UpperMaskNode = openvdb::tree::InternalNode<LowerMaskNode, 3>;  // 512^3 voxels
// The root of an openvdb::tree::Tree4<openvdb::ValueMask, 3, 3, 3>::Type. The tree class around it
// adds only input and output, which would load the whole library at every start.
using MaskTree = openvdb::tree::RootNode<UpperMaskNode>;
using openvdb::Coord;

inline std::uint64_t* words_of(MaskLeaf& leaf) { return leaf.buffer().data(); }
inline const std::uint64_t* words_of(const MaskLeaf& leaf) { return leaf.buffer().data(); }

inline lattice::BrickMask brick_of(const MaskLeaf& leaf) {
  lattice::BrickMask mask;
  const std::uint64_t* words = words_of(leaf);
  for (int x = 0; x < 8; ++x) mask.words[x] = words[x];
  return mask;
}

inline void assign(MaskLeaf& leaf, const lattice::BrickMask& mask) {
  std::uint64_t* words = words_of(leaf);
  for (int x = 0; x < 8; ++x) words[x] = mask.words[x];
}

// The 512 bits of a node's own mask (children or active tiles), in the order of BrickMask.
template <class NodeMask>
lattice::BrickMask mask_of(const NodeMask& node_mask) {
  lattice::BrickMask mask;
  for (openvdb::Index x = 0; x < 8; ++x) {
    mask.words[x] = node_mask.template getWord<std::uint64_t>(x);
  }
  return mask;
}

// Lowest voxel of entry n (0..511) of a node at `origin` with entries of `edge` voxels.
inline Coord entry_origin(const Coord& origin, unsigned n, int edge) {
  return origin.offsetBy(static_cast<int>(n >> 6) * edge, static_cast<int>(n >> 3 & 7) * edge,
                         static_cast<int>(n & 7) * edge);
}

// Puts `node` into the tree, in place of the node or tile there.
void add_node(MaskTree& tree, std::unique_ptr<LowerMaskNode> node);

// A tree of these nodes, which it takes; empty ones are left out.
std::unique_ptr<MaskTree> tree_of_nodes(std::vector<std::unique_ptr<LowerMaskNode>>& nodes);

// Adds the voxels of `other`, moving its nodes where possible.
void unite(MaskTree& tree, MaskTree&& other);

std::uint64_t voxel_count(const MaskTree& tree);

}  // namespace forcelayer::masks

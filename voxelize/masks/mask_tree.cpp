#include "voxelize/masks/mask_tree.h"

#include "voxelize/masks/brick_bits.h"

namespace forcelayer {
namespace {

// Adds the voxels of `other` to `leaf`.
void unite_leaves(MaskLeaf& leaf, const MaskLeaf& other) {
  assign(leaf, brick_of(leaf) | brick_of(other));
}

// Adds entry n of `other`, which is taken out of it, to the same entry of `node`. An active tile
// holds everything that could be added to it.
template <class Node, class UniteChildren>
void unite_entry(Node& node, Node& other, unsigned n, UniteChildren&& unite_children) {
  if (node.getValueMask().isOn(n)) return;
  if (other.getValueMask().isOn(n)) {
    node.addTile(n, true, true);
    return;
  }
  if (other.getChildMask().isOff(n)) return;
  auto* child = const_cast<typename Node::ChildNodeType*>(other.getTable()[n].getChild());
  if (node.getChildMask().isOn(n)) {
    unite_children(*const_cast<typename Node::ChildNodeType*>(node.getTable()[n].getChild()),
                   *child);
  } else {
    node.addChild(
        other.template stealNode<typename Node::ChildNodeType>(child->origin(), false, false));
  }
}

template <class Node, class UniteChildren>
void unite_nodes(Node& node, Node& other, UniteChildren&& unite_children) {
  const BrickMask used = mask_of(other.getChildMask()) | mask_of(other.getValueMask());
  for_each_set(used, [&](unsigned n) { unite_entry(node, other, n, unite_children); });
}

void unite_blocks(UpperMaskNode& block, UpperMaskNode& other) {
  unite_nodes(block, other, [](LowerMaskNode& node, LowerMaskNode& other_node) {
    unite_nodes(node, other_node,
                [](MaskLeaf& leaf, const MaskLeaf& other_leaf) { unite_leaves(leaf, other_leaf); });
  });
}

}  // namespace

void add_node(MaskTree& tree, std::unique_ptr<LowerMaskNode> node) {
  const Coord origin = node->origin();
  UpperMaskNode* block = tree.probeNode<UpperMaskNode>(origin);
  if (block == nullptr) {
    block = new UpperMaskNode(origin, false, false);
    tree.addChild(block);
  }
  block->addChild(node.release());
}

void unite(MaskTree& tree, MaskTree&& other) {
  std::vector<Coord> full_blocks, blocks;
  for (auto tile = other.cbeginValueOn(); tile; ++tile) {
    full_blocks.push_back(tile.getCoord());
  }
  for (auto block = other.cbeginChildOn(); block; ++block) blocks.push_back(block->origin());
  for (const Coord& origin : full_blocks) tree.addTile(origin, true, true);
  for (const Coord& origin : blocks) {
    if (tree.isValueOn(origin) && tree.probeConstNode<UpperMaskNode>(origin) == nullptr) {
      continue;  // a full block
    }
    UpperMaskNode* other_block = other.probeNode<UpperMaskNode>(origin);
    if (UpperMaskNode* block = tree.probeNode<UpperMaskNode>(origin)) {
      unite_blocks(*block, *other_block);
    } else {
      tree.addChild(other.stealNode<UpperMaskNode>(origin, false, false));
    }
  }
}

std::uint64_t voxel_count(const MaskTree& tree) { return tree.onVoxelCount(); }

}  // namespace forcelayer

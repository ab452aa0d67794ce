#include "voxelize/masks/mask_tree.h"

#include "formats/lattice/brick_bits.h"

namespace forcelayer::masks {
namespace {

// Adds the voxels of `other` to `leaf`.
void unite_leaves(MaskLeaf& leaf, const MaskLeaf& other) {
  assign(leaf, brick_of(leaf) | brick_of(other));
}

// Moves entry n of `other` into the same entry of `node`. An active tile already holds all voxels.
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
  const lattice::BrickMask used = mask_of(other.getChildMask()) | mask_of(other.getValueMask());
  lattice::for_each_set(used, [&](unsigned n) { unite_entry(node, other, n, unite_children); });
}

void unite_upper_nodes(UpperMaskNode& upper, UpperMaskNode& other) {
  unite_nodes(upper, other, [](LowerMaskNode& node, LowerMaskNode& other_node) {
    unite_nodes(node, other_node,
                [](MaskLeaf& leaf, const MaskLeaf& other_leaf) { unite_leaves(leaf, other_leaf); });
  });
}

}  // namespace

void add_node(MaskTree& tree, std::unique_ptr<LowerMaskNode> node) {
  const Coord origin = node->origin();
  UpperMaskNode* upper = tree.probeNode<UpperMaskNode>(origin);
  if (upper == nullptr) {
    upper = new UpperMaskNode(origin, false, false);
    tree.addChild(upper);
  }
  upper->addChild(node.release());
}

std::unique_ptr<MaskTree> tree_of_nodes(std::vector<std::unique_ptr<LowerMaskNode>>& nodes) {
  auto tree = std::make_unique<MaskTree>();
  for (auto& node : nodes) {
    if (!node->getChildMask().isOff()) add_node(*tree, std::move(node));
  }
  return tree;
}

void unite(MaskTree& tree, MaskTree&& other) {
  std::vector<Coord> full_cells, cells;
  for (auto tile = other.cbeginValueOn(); tile; ++tile) {
    full_cells.push_back(tile.getCoord());
  }
  for (auto upper = other.cbeginChildOn(); upper; ++upper) cells.push_back(upper->origin());
  for (const Coord& origin : full_cells) tree.addTile(origin, true, true);
  for (const Coord& origin : cells) {
    if (tree.isValueOn(origin) && tree.probeConstNode<UpperMaskNode>(origin) == nullptr) {
      continue;  // a full directory cell
    }
    UpperMaskNode* other_upper = other.probeNode<UpperMaskNode>(origin);
    if (UpperMaskNode* upper = tree.probeNode<UpperMaskNode>(origin)) {
      unite_upper_nodes(*upper, *other_upper);
    } else {
      tree.addChild(other.stealNode<UpperMaskNode>(origin, false, false));
    }
  }
}

std::uint64_t voxel_count(const MaskTree& tree) { return tree.onVoxelCount(); }

}  // namespace forcelayer::masks

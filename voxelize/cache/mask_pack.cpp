#include "voxelize/cache/mask_pack.h"

#include <bit>

#include "formats/lattice/brick_bits.h"

namespace forcelayer {
namespace {

constexpr int kLog2Cell = 9;

// A node's active tiles and children, 512 bits each; its children follow.
struct NodeRecord {
  BrickMask tiles, children;
};

// World voxel index / 512.
VoxelIndex cell_of(const Coord& voxel, const VoxelIndex& origin) {
  VoxelIndex cell;
  for (std::size_t d = 0; d < 3; ++d) cell[d] = (voxel[d] + origin[d]) >> kLog2Cell;
  return cell;
}

template <class Node>
NodeRecord record_of(const Node& node) {
  return {mask_of(node.getValueMask()), mask_of(node.getChildMask())};
}

void pack_node(const LowerMaskNode& node, BytePacker& packer) {
  const NodeRecord record = record_of(node);
  packer.value(record);
  for_each_set(record.children,
               [&](unsigned n) { packer.value(brick_of(*node.getTable()[n].getChild())); });
}

template <class Node>
void add_tiles(const BrickMask& tiles, Node& node) {
  for_each_set(tiles, [&](unsigned n) { node.addTile(n, true, true); });
}

NodeRecord read_record(ByteUnpacker& unpacker) {
  const auto record = unpacker.value<NodeRecord>();
  if ((record.tiles & record.children).any()) throw BadPack{};
  return record;
}

std::unique_ptr<LowerMaskNode> unpack_node(ByteUnpacker& unpacker, const Coord& origin) {
  const NodeRecord record = read_record(unpacker);
  auto node = std::make_unique<LowerMaskNode>(origin, false, false);
  add_tiles(record.tiles, *node);
  for_each_set(record.children, [&](unsigned n) {
    auto leaf = std::make_unique<MaskLeaf>(entry_origin(origin, n, 8), false);
    assign(*leaf, unpacker.value<BrickMask>());
    node->addLeaf(leaf.release());
  });
  return node;
}

Coord cell_origin(const VoxelIndex& cell, const VoxelIndex& origin, const VoxelBox& box) {
  Coord coord;
  for (std::size_t d = 0; d < 3; ++d) {
    if (cell[d] < box.low[d] >> kLog2Cell || cell[d] > box.high[d] >> kLog2Cell) {
      throw BadPack{};
    }
    coord[static_cast<int>(d)] = static_cast<int>((cell[d] << kLog2Cell) - origin[d]);
  }
  return coord;
}

}  // namespace

void pack(const MaskTree& tree, const VoxelIndex& origin, BytePacker& packer) {
  std::vector<VoxelIndex> full_cells;
  std::vector<const UpperMaskNode*> uppers;
  for (auto tile = tree.cbeginValueOn(); tile; ++tile) {
    full_cells.push_back(cell_of(tile.getCoord(), origin));
  }
  for (auto upper = tree.cbeginChildOn(); upper; ++upper) uppers.push_back(&*upper);
  packer.list(full_cells);
  packer.value(std::uint64_t{uppers.size()});
  for (const UpperMaskNode* upper : uppers) {
    const NodeRecord record = record_of(*upper);
    packer.value(cell_of(upper->origin(), origin));
    packer.value(record);
    for_each_set(record.children,
                 [&](unsigned n) { pack_node(*upper->getTable()[n].getChild(), packer); });
  }
}

std::unique_ptr<MaskTree> unpack(ByteUnpacker& unpacker, const VoxelIndex& origin,
                                 const VoxelBox& box) {
  auto tree = std::make_unique<MaskTree>();
  for (const VoxelIndex& cell : unpacker.list<VoxelIndex>()) {
    tree->addTile(cell_origin(cell, origin, box), true, true);
  }
  for (auto count = unpacker.value<std::uint64_t>(); count > 0; --count) {
    const auto cell = unpacker.value<VoxelIndex>();
    const Coord at = cell_origin(cell, origin, box);
    const NodeRecord record = read_record(unpacker);
    auto upper = std::make_unique<UpperMaskNode>(at, false, false);
    add_tiles(record.tiles, *upper);
    for_each_set(record.children, [&](unsigned n) {
      upper->addChild(unpack_node(unpacker, entry_origin(at, n, 64)).release());
    });
    tree->addChild(upper.release());
  }
  return tree;
}

}  // namespace forcelayer

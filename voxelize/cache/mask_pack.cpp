#include "voxelize/cache/mask_pack.h"

#include <bit>

#include "voxelize/masks/brick_bits.h"

namespace forcelayer {
namespace {

constexpr int kLog2Block = 9;

// A node's active tiles and children, 512 bits each; its children follow.
struct NodeRecord {
  BrickMask tiles, children;
};

// World voxel index / 512.
VoxelIndex block_of(const Coord& voxel, const VoxelIndex& origin) {
  VoxelIndex block;
  for (std::size_t d = 0; d < 3; ++d) block[d] = (voxel[d] + origin[d]) >> kLog2Block;
  return block;
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

Coord block_origin(const VoxelIndex& block, const VoxelIndex& origin, const VoxelBox& box) {
  Coord coord;
  for (std::size_t d = 0; d < 3; ++d) {
    if (block[d] < box.low[d] >> kLog2Block || block[d] > box.high[d] >> kLog2Block) {
      throw BadPack{};
    }
    coord[static_cast<int>(d)] = static_cast<int>((block[d] << kLog2Block) - origin[d]);
  }
  return coord;
}

}  // namespace

void pack(const MaskTree& tree, const VoxelIndex& origin, BytePacker& packer) {
  std::vector<VoxelIndex> full_blocks;
  std::vector<const UpperMaskNode*> blocks;
  for (auto tile = tree.cbeginValueOn(); tile; ++tile) {
    full_blocks.push_back(block_of(tile.getCoord(), origin));
  }
  for (auto block = tree.cbeginChildOn(); block; ++block) blocks.push_back(&*block);
  packer.list(full_blocks);
  packer.value(std::uint64_t{blocks.size()});
  for (const UpperMaskNode* block : blocks) {
    const NodeRecord record = record_of(*block);
    packer.value(block_of(block->origin(), origin));
    packer.value(record);
    for_each_set(record.children,
                 [&](unsigned n) { pack_node(*block->getTable()[n].getChild(), packer); });
  }
}

std::unique_ptr<MaskTree> unpack(ByteUnpacker& unpacker, const VoxelIndex& origin,
                                 const VoxelBox& box) {
  auto tree = std::make_unique<MaskTree>();
  for (const VoxelIndex& block : unpacker.list<VoxelIndex>()) {
    tree->addTile(block_origin(block, origin, box), true, true);
  }
  for (auto count = unpacker.value<std::uint64_t>(); count > 0; --count) {
    const auto block = unpacker.value<VoxelIndex>();
    const Coord at = block_origin(block, origin, box);
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

#include "voxelize/cache/mask_pack.h"

#include <bit>

#include "formats/lattice/brick_bits.h"

namespace forcelayer::cache {
namespace {

constexpr int kLog2Cell = 9;

// A node's active tiles and children, 512 bits each; its children follow.
struct NodeRecord {
  lattice::BrickMask tiles, children;
};

// World voxel index / 512.
lattice::VoxelIndex cell_of(const masks::Coord& voxel, const lattice::VoxelIndex& origin) {
  lattice::VoxelIndex cell;
  for (std::size_t d = 0; d < 3; ++d) cell[d] = (voxel[d] + origin[d]) >> kLog2Cell;
  return cell;
}

template <class Node>
NodeRecord record_of(const Node& node) {
  return {masks::mask_of(node.getValueMask()), masks::mask_of(node.getChildMask())};
}

void pack_node(const masks::LowerMaskNode& node, BytePacker& packer) {
  const NodeRecord record = record_of(node);
  packer.value(record);
  lattice::for_each_set(record.children, [&](unsigned n) {
    packer.value(masks::brick_of(*node.getTable()[n].getChild()));
  });
}

template <class Node>
void add_tiles(const lattice::BrickMask& tiles, Node& node) {
  lattice::for_each_set(tiles, [&](unsigned n) { node.addTile(n, true, true); });
}

NodeRecord read_record(ByteUnpacker& unpacker) {
  const auto record = unpacker.value<NodeRecord>();
  if ((record.tiles & record.children).any()) throw BadPack{};
  return record;
}

std::unique_ptr<masks::LowerMaskNode> unpack_node(ByteUnpacker& unpacker,
                                                  const masks::Coord& origin) {
  const NodeRecord record = read_record(unpacker);
  auto node = std::make_unique<masks::LowerMaskNode>(origin, false, false);
  add_tiles(record.tiles, *node);
  lattice::for_each_set(record.children, [&](unsigned n) {
    auto leaf = std::make_unique<masks::MaskLeaf>(masks::entry_origin(origin, n, 8), false);
    masks::assign(*leaf, unpacker.value<lattice::BrickMask>());
    node->addLeaf(leaf.release());
  });
  return node;
}

masks::Coord cell_origin(const lattice::VoxelIndex& cell, const lattice::VoxelIndex& origin,
                         const masks::VoxelBox& box) {
  masks::Coord coord;
  for (std::size_t d = 0; d < 3; ++d) {
    if (cell[d] < box.low[d] >> kLog2Cell || cell[d] > box.high[d] >> kLog2Cell) {
      throw BadPack{};
    }
    coord[static_cast<int>(d)] = static_cast<int>((cell[d] << kLog2Cell) - origin[d]);
  }
  return coord;
}

}  // namespace

void pack(const masks::MaskTree& tree, const lattice::VoxelIndex& origin, BytePacker& packer) {
  std::vector<lattice::VoxelIndex> full_cells;
  std::vector<const masks::UpperMaskNode*> uppers;
  for (auto tile = tree.cbeginValueOn(); tile; ++tile) {
    full_cells.push_back(cell_of(tile.getCoord(), origin));
  }
  for (auto upper = tree.cbeginChildOn(); upper; ++upper) uppers.push_back(&*upper);
  packer.list(full_cells);
  packer.value(std::uint64_t{uppers.size()});
  for (const masks::UpperMaskNode* upper : uppers) {
    const NodeRecord record = record_of(*upper);
    packer.value(cell_of(upper->origin(), origin));
    packer.value(record);
    lattice::for_each_set(record.children,
                          [&](unsigned n) { pack_node(*upper->getTable()[n].getChild(), packer); });
  }
}

std::unique_ptr<masks::MaskTree> unpack(ByteUnpacker& unpacker, const lattice::VoxelIndex& origin,
                                        const masks::VoxelBox& box) {
  auto tree = std::make_unique<masks::MaskTree>();
  for (const lattice::VoxelIndex& cell : unpacker.list<lattice::VoxelIndex>()) {
    tree->addTile(cell_origin(cell, origin, box), true, true);
  }
  for (auto count = unpacker.value<std::uint64_t>(); count > 0; --count) {
    const auto cell = unpacker.value<lattice::VoxelIndex>();
    const masks::Coord at = cell_origin(cell, origin, box);
    const NodeRecord record = read_record(unpacker);
    auto upper = std::make_unique<masks::UpperMaskNode>(at, false, false);
    add_tiles(record.tiles, *upper);
    lattice::for_each_set(record.children, [&](unsigned n) {
      upper->addChild(unpack_node(unpacker, masks::entry_origin(at, n, 64)).release());
    });
    tree->addChild(upper.release());
  }
  return tree;
}

}  // namespace forcelayer::cache

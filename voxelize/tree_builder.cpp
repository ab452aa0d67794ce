#include "voxelize/tree_builder.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <compare>
#include <cstring>
#include <string_view>
#include <unordered_map>

#include "formats/voxmap_format.h"
#include "voxelize/brick_bits.h"

namespace forcelayer {
namespace {

using Brick = std::array<std::uint32_t, 32>;     // 512 two-bit values
using Entries = std::array<std::uint32_t, 512>;  // of a node

constexpr std::uint32_t kFree = uniform_entry(0);
constexpr std::uint32_t kInterior =
    uniform_entry(static_cast<std::uint32_t>(VoxelValue::kInterior));

struct BuiltNode {
  Entries entries;            // uniform, or the number of a brick below
  std::vector<Brick> bricks;  // of this node, ascending by entry
  ValueCounts counts;
};

// The low 32 bits, each moved to every second bit.
std::uint64_t spread_bits(std::uint64_t bits) {
  bits &= 0xffffffffu;
  bits = (bits | bits << 16) & 0x0000ffff0000ffffu;
  bits = (bits | bits << 8) & 0x00ff00ff00ff00ffu;
  bits = (bits | bits << 4) & 0x0f0f0f0f0f0f0f0fu;
  bits = (bits | bits << 2) & 0x3333333333333333u;
  return (bits | bits << 1) & 0x5555555555555555u;
}

// Byte i of word j becomes byte j of word i.
void transpose_bytes(std::array<std::uint64_t, 8>& words) {
  const auto swap_blocks = [&](std::size_t distance, std::uint64_t mask) {
    const int shift = static_cast<int>(distance) * 8;
    for (std::size_t i = 0; i < 8; ++i) {
      if (i & distance) continue;
      const std::uint64_t moved = (words[i] >> shift ^ words[i + distance]) & mask;
      words[i + distance] ^= moved;
      words[i] ^= moved << shift;
    }
  };
  swap_blocks(4, 0x00000000ffffffffu);
  swap_blocks(2, 0x0000ffff0000ffffu);
  swap_blocks(1, 0x00ff00ff00ff00ffu);
}

constexpr bool is_full_or_empty(unsigned byte) { return byte == 0 || byte == 0xff; }

// A column of eight bricks along z, out of a node's rows.
class BrickColumn {
 public:
  BrickColumn(const NodeCodes& codes, unsigned bx, unsigned by) {
    std::uint64_t any_low = 0, all_low = kAllBits, any_high = 0, all_high = kAllBits;
    for (unsigned x = 0; x < 8; ++x) {
      for (unsigned y = 0; y < 8; ++y) {
        const std::size_t row = (bx * 8 + x) * 64 + by * 8 + y;
        low_[x][y] = codes.low[row];
        high_[x][y] = codes.high[row];
        any_low |= low_[x][y];
        all_low &= low_[x][y];
        any_high |= high_[x][y];
        all_high &= high_[x][y];
      }
    }
    for (unsigned z = 0; z < 8; ++z) {
      const auto byte = [z](std::uint64_t word) {
        return static_cast<unsigned>(word >> 8 * z & 0xff);
      };
      const bool same = byte(any_low) == byte(all_low) && byte(any_high) == byte(all_high) &&
                        is_full_or_empty(byte(any_low)) && is_full_or_empty(byte(any_high));
      uniform_[z] = same ? static_cast<int>((byte(any_low) & 1) | (byte(any_high) & 1) << 1) : -1;
    }
  }

  // The one value of brick z, or -1.
  int uniform(unsigned z) const { return uniform_[z]; }

  bool all_uniform() const {
    return std::none_of(uniform_.begin(), uniform_.end(), [](int value) { return value < 0; });
  }

  // Before brick(): rows to bricks.
  void transpose() {
    for (auto& words : low_) transpose_bytes(words);
    for (auto& words : high_) transpose_bytes(words);
  }

  Brick brick(unsigned z) const {
    Brick brick;
    for (std::size_t x = 0; x < 8; ++x) {
      const std::uint64_t low = low_[x][z], high = high_[x][z];
      const std::uint64_t halves[2] = {spread_bits(low) | spread_bits(high) << 1,
                                       spread_bits(low >> 32) | spread_bits(high >> 32) << 1};
      std::memcpy(&brick[x * 4], halves, sizeof halves);
    }
    return brick;
  }

 private:
  std::array<std::array<std::uint64_t, 8>, 8> low_, high_;  // [x][y] rows, then [x][z] brick words
  std::array<int, 8> uniform_;
};

void cut_into_bricks(const NodeCodes& codes, BuiltNode& node) {
  for (unsigned bx = 0; bx < 8; ++bx) {
    for (unsigned by = 0; by < 8; ++by) {
      BrickColumn column(codes, bx, by);
      if (!column.all_uniform()) column.transpose();
      for (unsigned bz = 0; bz < 8; ++bz) {
        std::uint32_t& entry = node.entries[bx * 64 + by * 8 + bz];
        if (column.uniform(bz) >= 0) {
          entry = uniform_entry(static_cast<std::uint32_t>(column.uniform(bz)));
        } else {
          entry = static_cast<std::uint32_t>(node.bricks.size());
          node.bricks.push_back(column.brick(bz));
        }
      }
    }
  }
}

std::vector<BuiltNode> build_nodes(const LayerOffset& offset, const std::vector<Coord>& origins) {
  struct Scratch {
    LayerOffset::Scratch offset;
    NodeCodes codes;
  };
  tbb::enumerable_thread_specific<Scratch> scratches;
  std::vector<BuiltNode> nodes(origins.size());
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
    Scratch& scratch = scratches.local();
    nodes[i].counts = offset.codes(origins[i], scratch.offset, scratch.codes);
    cut_into_bricks(scratch.codes, nodes[i]);
  });
  return nodes;
}

// Appends records of `kWords` words to an array, each different one once.
template <std::size_t kWords>
class UniqueRecords {
 public:
  explicit UniqueRecords(std::vector<std::uint32_t>& array) : array_(array) {}

  std::uint32_t add(const std::array<std::uint32_t, kWords>& record) {
    const std::string_view bytes(reinterpret_cast<const char*>(record.data()), sizeof record);
    const auto number = static_cast<std::uint32_t>(array_.size() / kWords);
    auto& same_hash = numbers_[std::hash<std::string_view>()(bytes)];
    for (const std::uint32_t candidate : same_hash) {
      if (std::equal(record.begin(), record.end(),
                     array_.begin() + std::ptrdiff_t{candidate} * kWords)) {
        return candidate;
      }
    }
    same_hash.push_back(number);
    array_.insert(array_.end(), record.begin(), record.end());
    return number;
  }

 private:
  std::vector<std::uint32_t>& array_;
  std::unordered_map<std::size_t, std::vector<std::uint32_t>> numbers_;
};

bool all_equal(const Entries& entries) {
  return is_uniform(entries[0]) &&
         std::all_of(entries.begin(), entries.end(),
                     [&](std::uint32_t entry) { return entry == entries[0]; });
}

// Puts the built nodes and the uniform space around them together.
class TreeAssembly {
 public:
  TreeAssembly(VoxelTree& tree, const std::array<std::uint32_t, 3>& dims)
      : tree_(tree),
        dims_(dims),
        bricks_(tree.bricks),
        lower_(tree.lower_nodes),
        upper_(tree.upper_nodes) {
    tree.directory.assign(std::size_t{dims[0]} * dims[1] * dims[2], kFree);
  }

  void add_interior_tiles(const MaskTree& interior);
  void add_blocks(const MaskTree& interior, const std::vector<Coord>& origins,
                  std::vector<BuiltNode>& nodes);

 private:
  struct Placed {  // a built node's place in the tree
    std::size_t block;
    unsigned entry;
    std::size_t node;
    auto operator<=>(const Placed&) const = default;
  };

  std::size_t block_at(const Coord& voxel) const {
    return (static_cast<std::size_t>(voxel.x() >> 9) * dims_[1] +
            static_cast<std::size_t>(voxel.y() >> 9)) *
               dims_[2] +
           static_cast<std::size_t>(voxel.z() >> 9);
  }
  std::uint32_t add_lower(BuiltNode& node);

  VoxelTree& tree_;
  std::array<std::uint32_t, 3> dims_;
  UniqueRecords<32> bricks_;
  UniqueRecords<512> lower_, upper_;
};

void TreeAssembly::add_interior_tiles(const MaskTree& interior) {
  for (auto tile = interior.root().cbeginValueOn(); tile; ++tile) {
    tree_.directory[block_at(tile.getCoord())] = kInterior;
  }
}

std::uint32_t TreeAssembly::add_lower(BuiltNode& node) {
  for (std::uint32_t& entry : node.entries) {
    if (!is_uniform(entry)) entry = bricks_.add(node.bricks[entry]);
  }
  tree_.counts += node.counts;
  return all_equal(node.entries) ? node.entries[0] : lower_.add(node.entries);
}

void TreeAssembly::add_blocks(const MaskTree& interior, const std::vector<Coord>& origins,
                              std::vector<BuiltNode>& nodes) {
  std::vector<Placed> order;
  for (std::size_t i = 0; i < origins.size(); ++i) {
    order.push_back({block_at(origins[i]), UpperMaskNode::coordToOffset(origins[i]), i});
  }
  std::sort(order.begin(), order.end());
  for (std::size_t i = 0; i < order.size();) {
    const std::size_t block = order[i].block;
    Entries entries;
    entries.fill(tree_.directory[block]);
    if (const auto* tiles = interior.root().probeConstNode<UpperMaskNode>(origins[order[i].node])) {
      for_each_set(mask_of(tiles->getValueMask()), [&](unsigned n) { entries[n] = kInterior; });
    }
    for (; i < order.size() && order[i].block == block; ++i) {
      entries[order[i].entry] = add_lower(nodes[order[i].node]);
    }
    tree_.directory[block] = all_equal(entries) ? entries[0] : upper_.add(entries);
  }
}

// Interior voxels of uniform entries above the built nodes, which count their own.
std::uint64_t uniform_interior(const VoxelTree& tree, std::size_t built_interior_nodes) {
  constexpr std::uint64_t kNode = 64 * 64 * 64;
  std::uint64_t nodes = 0;
  for (const std::uint32_t entry : tree.directory) {
    if (entry == kInterior) nodes += 512;
    if (is_uniform(entry)) continue;
    const auto first = tree.upper_nodes.begin() + std::ptrdiff_t{entry} * 512;
    nodes += static_cast<std::uint64_t>(std::count(first, first + 512, kInterior));
  }
  return (nodes - built_interior_nodes) * kNode;
}

}  // namespace

VoxelTree build_tree(const LayerOffset& offset, const MaskTree& interior,
                     const std::array<std::uint32_t, 3>& directory_dims) {
  const std::vector<Coord> origins = offset.nodes();
  std::vector<BuiltNode> nodes = build_nodes(offset, origins);
  VoxelTree tree;
  TreeAssembly assembly(tree, directory_dims);
  assembly.add_interior_tiles(interior);
  assembly.add_blocks(interior, origins, nodes);
  const auto solid_nodes = std::count_if(nodes.begin(), nodes.end(), [](const BuiltNode& node) {
    return node.counts.interior == 64 * 64 * 64;
  });
  tree.counts.interior += uniform_interior(tree, static_cast<std::size_t>(solid_nodes));
  return tree;
}

}  // namespace forcelayer

// The lower nodes and bricks of a tree in a cache entry.
#pragma once

#include <algorithm>
#include <cstring>
#include <span>

#include "formats/lattice/brick_bits.h"
#include "voxelize/cache/byte_pack.h"
#include "voxelize/tree/built_tree.h"
#include "voxelize/tree/sharing.h"

namespace forcelayer::tree {

class StoredNodes {
 public:
  StoredNodes() = default;

  // Views the bytes that keep() packed, without a copy. Throws BadPack where a node points to a
  // brick that is not there.
  StoredNodes(cache::ByteUnpacker& unpacker, std::uint32_t brick_parts)
      : parts_(brick_parts),
        nodes_(unpacker.list<std::uint32_t>()),
        bricks_(unpacker.list<std::uint32_t>()) {
    const std::size_t bricks = bricks_.size() / (kBrickWords * parts_);
    if (!std::all_of(nodes_.begin(), nodes_.end(),
                     [&](std::uint32_t entry) { return is_uniform(entry) || entry < bricks; })) {
      throw cache::BadPack{};
    }
  }
  static void keep(const VoxelTree& tree, cache::BytePacker& packer) {
    packer.list(tree.lower_nodes);
    packer.list(tree.bricks);
  }

  // Whether `entry`, of a node above, is uniform or the number of a node here.
  bool has(std::uint32_t entry) const {
    return is_uniform(entry) || entry < nodes_.size() / kNodeEntries;
  }

  // The node of this entry, with bricks of its own.
  BuiltNode node(std::uint32_t entry) const {
    BuiltNode node;
    if (is_uniform(entry)) {
      node.entries.fill(entry);
      return node;
    }
    const auto entries = nodes_.subspan(std::size_t{entry} * kNodeEntries, kNodeEntries);
    node.bricks.reserve(parts_ * static_cast<std::size_t>(std::count_if(
                                     entries.begin(), entries.end(),
                                     [](std::uint32_t of_box) { return !is_uniform(of_box); })));
    for (unsigned n = 0; n < kNodeEntries; ++n) {
      node.entries[n] = entries[n];
      if (!is_free(entries[n])) set(node.held, n);
      if (is_uniform(entries[n])) continue;
      node.entries[n] = static_cast<std::uint32_t>(node.bricks.size() / parts_);
      node.bricks.resize(node.bricks.size() + parts_);
      std::memcpy(node.bricks[node.bricks.size() - parts_].data(),
                  bricks_.data() + std::size_t{entries[n]} * kBrickWords * parts_,
                  sizeof(Brick) * parts_);
    }
    return node;
  }

 private:
  static constexpr std::size_t kBrickWords = std::tuple_size_v<Brick>;

  std::size_t parts_ = 1;
  std::span<const std::uint32_t> nodes_, bricks_;
};

}  // namespace forcelayer::tree

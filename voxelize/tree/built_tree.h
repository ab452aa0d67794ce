// The 512-tree while it is being built: as in the file, but nothing is shared yet.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/voxmap_format.h"
#include "voxelize/tree/side_gaps.h"

namespace forcelayer::tree {

using Entries = std::array<std::uint32_t, kNodeEntries>;  // of a node, as in the file
using Brick = std::array<std::uint32_t, 32>;  // 512 two-bit values; wider elements take several

inline constexpr std::uint32_t kFreeEntry = uniform_entry(0);
constexpr bool is_free(std::uint32_t entry) {
  return is_uniform(entry) && uniform_value(entry) == 0;
}
inline constexpr std::uint32_t kInteriorEntry =
    uniform_entry(static_cast<std::uint32_t>(VoxelValue::kInterior));

// A node of 64^3 voxels.
struct BuiltNode {
  Entries entries;              // uniform, or the number of a brick below
  lattice::BrickMask held;      // entries that are not free
  std::vector<Brick> bricks;    // ascending by entry, BuiltTree::brick_parts each
  std::vector<BrickGaps> gaps;  // [bricks]
  // Taken over from an earlier bake: its entries hold their clearance and node_gaps is set, but
  // `gaps` is empty.
  bool finished = false;
  NodeGaps node_gaps;  // set by add_clearance()
};

struct BuiltTree {
  std::array<std::uint32_t, 3> dims{};   // directory cells (512^3 voxels)
  std::vector<std::uint32_t> directory;  // uniform, or the number of an upper node
  std::vector<Entries> upper;            // uniform, or the number of a lower node
  std::vector<BuiltNode> lower;
  std::uint32_t brick_parts = 1;  // of a brick, 128 bytes each

  // Entry of directory cell (x, y, z); free outside the directory.
  std::uint32_t directory_entry(std::int64_t x, std::int64_t y, std::int64_t z) const {
    if (x < 0 || y < 0 || z < 0 || x >= dims[0] || y >= dims[1] || z >= dims[2]) return kFreeEntry;
    return directory[(static_cast<std::size_t>(x) * dims[1] + static_cast<std::size_t>(y)) *
                         dims[2] +
                     static_cast<std::size_t>(z)];
  }

  // Entry of the 64^3 node (x, y, z), counted from the directory's origin.
  std::uint32_t node(std::int64_t x, std::int64_t y, std::int64_t z) const {
    const std::uint32_t entry = directory_entry(x >> 3, y >> 3, z >> 3);
    if (is_uniform(entry)) return entry;
    return upper[entry][static_cast<std::size_t>((x & 7) << 6 | (y & 7) << 3 | (z & 7))];
  }
};

}  // namespace forcelayer::tree

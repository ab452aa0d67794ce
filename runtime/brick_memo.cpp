#include "runtime/brick_memo.h"

namespace forcelayer {
namespace {

// Of a node's 512 entries the one that holds a brick, by three bits of each coordinate.
std::uint64_t entry_number(const BrickMemo::BrickIndex& brick, int shift) {
  const auto digit = [shift](std::int32_t i) { return static_cast<std::uint64_t>(i >> shift & 7); };
  return digit(brick[0]) * 64 + digit(brick[1]) * 8 + digit(brick[2]);
}

// The entry for the 64^3 voxels around a brick of the directory: a lower node, or uniform.
std::uint32_t lower_entry(const VoxmapView& map, const BrickMemo::BrickIndex& brick) {
  const auto& dims = map.directory_dims;
  const std::uint32_t entry =
      map.directory[(std::int64_t{brick[0] >> 6} * dims[1] + (brick[1] >> 6)) * dims[2] +
                    (brick[2] >> 6)];
  if (is_uniform(entry)) return entry;
  return map.upper_nodes[std::uint64_t{entry} * kNodeEntries + entry_number(brick, 3)];
}

// The entry of a brick below `lower`, a lower node or uniform.
std::uint32_t entry_below(const VoxmapView& map, std::uint32_t lower,
                          const BrickMemo::BrickIndex& brick) {
  if (is_uniform(lower)) return lower;
  return map.lower_nodes[std::uint64_t{lower} * kNodeEntries + entry_number(brick, 0)];
}

}  // namespace

BrickMemo::BrickMemo(const Voxmap& voxmap)
    : keys_(kSlots, kNoKey), tags_(std::size_t{4} * kSlots, kNone) {
  const VoxmapHeader& header = voxmap.header();
  const auto& blocks = header.directory_dims;
  strides_ = {blocks[1] * blocks[2] * 64 * 64, blocks[2] * 64, 1};
  keys_are_unique_ = std::uint64_t{blocks[0]} * blocks[1] * blocks[2] < kNoKey / (64 * 64 * 64);
  known_ = known_box(header, header.directory_origin);
}

bool BrickMemo::near_cropped_side(const BrickIndex& brick) const noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t low = std::int64_t{8} * brick[axis];
    if (low - 1 < known_.low[axis] || low + 9 > known_.high[axis]) return true;
  }
  return false;
}

std::uint32_t brick_entry(const VoxmapView& map, const BrickMemo::BrickIndex& brick,
                          std::uint32_t outside) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (brick[axis] < 0 || brick[axis] >> 6 >= map.directory_dims[axis]) return outside;
  }
  return entry_below(map, lower_entry(map, brick), brick);
}

std::array<std::uint32_t, 27> entries_around(const VoxmapView& map,
                                             const BrickMemo::BrickIndex& brick,
                                             std::uint32_t outside) noexcept {
  std::array<std::uint32_t, 27> entries{};
  bool in_one_node = true;
  for (const std::int32_t b : brick) in_one_node = in_one_node && (b & 7) > 0 && (b & 7) < 7;
  const std::uint32_t lower = in_one_node ? lower_entry(map, brick) : 0;
  for (int n = 0; n < 27; ++n) {
    const BrickMemo::BrickIndex neighbour{brick[0] + n / 9 - 1, brick[1] + n / 3 % 3 - 1,
                                          brick[2] + n % 3 - 1};
    entries[static_cast<std::size_t>(n)] =
        in_one_node ? entry_below(map, lower, neighbour) : brick_entry(map, neighbour, outside);
  }
  return entries;
}

}  // namespace forcelayer

#include "runtime/field/brick_cache.h"

namespace forcelayer::field {
namespace {

// Number of the entry of a node that leads to a brick: three bits of each coordinate.
std::uint64_t entry_number(const BrickCache::BrickIndex& brick, int shift) {
  const auto digit = [shift](std::int32_t i) { return static_cast<std::uint64_t>(i >> shift & 7); };
  return digit(brick[0]) * 64 + digit(brick[1]) * 8 + digit(brick[2]);
}

// The entry of the 64^3 voxels around a brick: a lower node, or uniform.
template <std::uint32_t kBits>
std::uint32_t lower_entry(const TreeView<kBits>& map, const BrickCache::BrickIndex& brick) {
  const auto& dims = map.directory_dims;
  const std::uint32_t entry =
      map.directory[(std::int64_t{brick[0] >> 6} * dims[1] + (brick[1] >> 6)) * dims[2] +
                    (brick[2] >> 6)];
  if (is_uniform(entry)) return entry;
  return map.upper_nodes[std::uint64_t{entry} * kNodeEntries + entry_number(brick, 3)];
}

// The entry of a brick below `lower`, a lower node or uniform.
template <std::uint32_t kBits>
std::uint32_t entry_below(const TreeView<kBits>& map, std::uint32_t lower,
                          const BrickCache::BrickIndex& brick) {
  if (is_uniform(lower)) return lower;
  return map.lower_nodes[std::uint64_t{lower} * kNodeEntries + entry_number(brick, 0)];
}

}  // namespace

BrickCache::BrickCache(const Voxmap& voxmap)
    : keys_(kSlots, kNoKey), tags_(std::size_t{4} * kSlots, kNone) {
  const VoxmapHeader& header = voxmap.header();
  const auto& cells = header.directory_dims;  // of 512^3 voxels: 64^3 bricks
  const std::uint64_t along[3] = {cells[0] * std::uint64_t{64}, cells[1] * std::uint64_t{64},
                                  cells[2] * std::uint64_t{64}};
  strides_ = {static_cast<std::uint32_t>(along[1] * along[2]), static_cast<std::uint32_t>(along[2]),
              1};
  // Then none of them is kNoKey either. There are at most 2^28 directory cells.
  keys_are_unique_ = along[0] * along[1] * along[2] < kNoKey;
  known_ = known_box(header, header.directory_origin);
}

bool BrickCache::near_cropped_side(const BrickIndex& brick) const noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int64_t low = std::int64_t{8} * brick[axis];
    if (low - 1 < known_.low[axis] || low + 9 > known_.high[axis]) return true;
  }
  return false;
}

template <std::uint32_t kBits>
std::uint32_t brick_entry(const TreeView<kBits>& map, const BrickCache::BrickIndex& brick,
                          std::uint32_t outside) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (brick[axis] < 0 || brick[axis] >> 6 >= map.directory_dims[axis]) return outside;
  }
  return entry_below(map, lower_entry(map, brick), brick);
}

template <std::size_t kEdge, std::uint32_t kBits>
std::array<std::uint32_t, kEdge * kEdge * kEdge> brick_entries(const TreeView<kBits>& map,
                                                               const BrickCache::BrickIndex& first,
                                                               std::uint32_t outside) noexcept {
  constexpr auto kSteps = static_cast<std::int32_t>(kEdge) - 1;
  bool in_one_node = true;
  for (const std::int32_t b : first) in_one_node = in_one_node && b >> 3 == (b + kSteps) >> 3;
  const std::uint32_t lower = in_one_node ? lower_entry(map, first) : 0;
  std::array<std::uint32_t, kEdge * kEdge * kEdge> entries;
  std::size_t n = 0;
  for (std::int32_t x = 0; x <= kSteps; ++x) {
    for (std::int32_t y = 0; y <= kSteps; ++y) {
      for (std::int32_t z = 0; z <= kSteps; ++z) {
        const BrickCache::BrickIndex brick{first[0] + x, first[1] + y, first[2] + z};
        entries[n++] =
            in_one_node ? entry_below(map, lower, brick) : brick_entry(map, brick, outside);
      }
    }
  }
  return entries;
}

template std::uint32_t brick_entry(const VoxmapView&, const BrickCache::BrickIndex&,
                                   std::uint32_t) noexcept;
template std::uint32_t brick_entry(const DistanceView&, const BrickCache::BrickIndex&,
                                   std::uint32_t) noexcept;
template std::array<std::uint32_t, 27> brick_entries<3>(const VoxmapView&,
                                                        const BrickCache::BrickIndex&,
                                                        std::uint32_t) noexcept;
template std::array<std::uint32_t, 27> brick_entries<3>(const DistanceView&,
                                                        const BrickCache::BrickIndex&,
                                                        std::uint32_t) noexcept;

}  // namespace forcelayer::field

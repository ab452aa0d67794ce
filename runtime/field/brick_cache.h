// Bricks that a force field has decoded, kept from frame to frame. A point in contact stays in its
// brick for many frames, so almost every look-up finds its brick decoded; a new brick replaces
// another one. No answer depends on earlier questions. For one thread at a time.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/voxmap.h"

namespace forcelayer::field {

// Where decoded bricks stand. A brick's key is its number in the directory, counted along z, then
// y, then x, modulo 2^32. A decoded brick stands in slot(key). The derived class holds what is
// decoded.
class BrickCache {
 public:
  static constexpr int kSlotBits = 12;
  static constexpr std::uint32_t kSlots = 1u << kSlotBits;
  static constexpr std::uint32_t kHash = 0x9e3779b1u;  // 2^32 over the golden ratio
  static constexpr std::uint32_t slot(std::uint32_t key) { return key * kHash >> (32 - kSlotBits); }

  using BrickIndex = std::array<std::int32_t, 3>;

  explicit BrickCache(const Voxmap& voxmap);

  // Difference of the keys of neighbors along x, y and z.
  const std::array<std::uint32_t, 3>& strides() const { return strides_; }
  // Per slot the key of its brick.
  const std::uint32_t* keys() const { return keys_.data(); }
  // Per slot the brick's x, y and z, and one unused element. Needed only where two bricks of the
  // map can have the same key.
  const std::int32_t* tags() const { return tags_.data(); }
  bool keys_are_unique() const { return keys_are_unique_; }

  // Gives a brick its slot; `held` says whether the brick stood there before.
  struct Place {
    std::uint32_t slot;
    bool held;
  };
  Place take_slot(const BrickIndex& brick) noexcept {
    const std::uint32_t key = static_cast<std::uint32_t>(brick[0]) * strides_[0] +
                              static_cast<std::uint32_t>(brick[1]) * strides_[1] +
                              static_cast<std::uint32_t>(brick[2]) * strides_[2];
    const std::uint32_t at = slot(key);
    std::int32_t* tag = &tags_[std::size_t{4} * at];
    const bool held = tag[0] == brick[0] && tag[1] == brick[1] && tag[2] == brick[2];
    keys_[at] = key;
    tag[0] = brick[0], tag[1] = brick[1], tag[2] = brick[2];
    return {at, held};
  }

  // Whether a voxel of the brick, or one next to it, lies beyond a cropped side.
  bool near_cropped_side(const BrickIndex& brick) const noexcept;
  // Box of the voxels that are known, relative to the directory; unbounded where no side is
  // cropped.
  const KnownBox& known() const { return known_; }

 private:
  static constexpr std::uint32_t kNoKey = 1u << 31;
  static constexpr std::int32_t kNone = INT32_MIN;

  std::array<std::uint32_t, 3> strides_{};
  bool keys_are_unique_ = false;
  KnownBox known_;
  std::vector<std::uint32_t> keys_;
  std::vector<std::int32_t> tags_;
};

// The tree entry of the brick of voxels 8 b to 8 b + 7, relative to the directory: a uniform value
// or the index of a stored brick. `outside` beyond the directory.
template <std::uint32_t kBits>
std::uint32_t brick_entry(const TreeView<kBits>& map, const BrickCache::BrickIndex& brick,
                          std::uint32_t outside) noexcept;

// The entries of kEdge^3 bricks from `first` on, z fastest.
template <std::size_t kEdge, std::uint32_t kBits>
std::array<std::uint32_t, kEdge * kEdge * kEdge> brick_entries(const TreeView<kBits>& map,
                                                               const BrickCache::BrickIndex& first,
                                                               std::uint32_t outside) noexcept;

}  // namespace forcelayer::field

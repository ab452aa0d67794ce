// Bricks decoded for a force field, kept from frame to frame: a point in contact stays in its brick
// for many frames, so that almost all look-ups find their brick; else the brick replaces another
// one. What is found never depends on what was asked before. Not for use by two threads at once.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/voxmap.h"

namespace forcelayer {

// Bricks of the directory are named by the number that they have along z, y and x, modulo 2^32: see
// strides(). The one of that key stands in slot(key), if any.
class BrickMemo {
 public:
  static constexpr int kSlotBits = 12;
  static constexpr std::uint32_t kSlots = 1u << kSlotBits;
  static constexpr std::uint32_t kHash = 0x9e3779b1u;  // 2^32 over the golden ratio
  static constexpr std::uint32_t slot(std::uint32_t key) { return key * kHash >> (32 - kSlotBits); }

  using BrickIndex = std::array<std::int32_t, 3>;

  explicit BrickMemo(const Voxmap& voxmap);

  // Keys of neighbours along x, y and z differ by this.
  const std::array<std::uint32_t, 3>& strides() const { return strides_; }
  // Per slot the key of the brick in it.
  const std::uint32_t* keys() const { return keys_.data(); }
  // Per slot the brick coordinates x, y, z, and one unused. They need a look only where the map has
  // so many bricks that two may have the same key.
  const std::int32_t* tags() const { return tags_.data(); }
  bool keys_are_unique() const { return keys_are_unique_; }

  // The slot of a brick, and whether it stands there already; from now on it is said to.
  struct Place {
    std::uint32_t slot;
    bool held;
  };
  Place take(const BrickIndex& brick) noexcept {
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

  // Whether a voxel of the brick or next to it is not known.
  bool near_cropped_side(const BrickIndex& brick) const noexcept;
  // Box of the voxels that are known, relative to the directory; unbounded where nothing was cut.
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

// The entry under which a brick's voxels stand, 8 b to 8 b + 7 relative to the directory: uniform,
// or the brick's number. `outside` beyond the directory.
std::uint32_t brick_entry(const VoxmapView& map, const BrickMemo::BrickIndex& brick,
                          std::uint32_t outside) noexcept;

// The same of kEdge^3 bricks from `first` on, by x, y and z.
template <std::size_t kEdge>
std::array<std::uint32_t, kEdge * kEdge * kEdge> brick_entries(const VoxmapView& map,
                                                               const BrickMemo::BrickIndex& first,
                                                               std::uint32_t outside) noexcept;

}  // namespace forcelayer

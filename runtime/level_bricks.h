// Levels around a point at one address: bricks of 8x8x8 voxels decoded with one voxel of halo, kept
// from frame to frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "formats/voxmap.h"

namespace forcelayer {

// One more than the level (runtime/level_field.h) of values 0 free, 1 interior, 2 surface, 3
// proximity, so that none is negative.
inline constexpr std::array<std::uint8_t, 4> kRaisedLevel{3, 0, 1, 2};

// A memo of decoded bricks. A point in contact stays in its brick for many frames, so that almost
// all look-ups find their brick; else the brick replaces another one. What is found never depends
// on what was asked before. Not for use by two threads at once.
//
// A decoded brick holds 10 planes (x) of 8 rows (y) of 10 bytes (z); each byte holds the raised
// levels of three voxels along y, those at y-1, y and y+1 in bits 0, 2 and 4, with y running over
// the brick's own voxels and x and z over the halo too. So the 27 levels around voxel (x, y, z) of
// the brick are bytes z to z+2 of row y in planes x to x+2; reading byte z+3 along with them stays
// inside the row's bytes.
class LevelBricks {
 public:
  static constexpr int kSlotBits = 12;
  static constexpr std::uint32_t kSlots = 1u << kSlotBits;
  static constexpr std::uint32_t kRowBytes = 12;
  static constexpr std::uint32_t kPlaneBytes = 8 * kRowBytes;
  static constexpr std::uint32_t kBrickBytes = 10 * kPlaneBytes;

  // The map has two bits per voxel and outlives this.
  explicit LevelBricks(const Voxmap& voxmap);

  // Bricks are named by the number that they have along z, y and x, modulo 2^32: see strides().
  // The one of that key stands in slot(key), if any.
  static constexpr std::uint32_t kHash = 0x9e3779b1u;  // 2^32 over the golden ratio
  static constexpr std::uint32_t slot(std::uint32_t key) { return key * kHash >> (32 - kSlotBits); }
  // Keys of neighbours along x, y and z differ by this.
  const std::array<std::uint32_t, 3>& strides() const { return strides_; }

  // Per slot the key of the brick in it.
  const std::uint32_t* keys() const { return keys_.data(); }
  // Per slot the brick coordinates x, y, z, and one unused. They need a look only where the map has
  // so many bricks that two may have the same key.
  const std::int32_t* tags() const { return tags_.data(); }
  bool keys_are_unique() const { return keys_are_unique_; }
  // Per slot kBrickBytes of raised levels.
  const std::uint8_t* levels() const { return levels_.data(); }

  // Decodes the brick of voxels 8 b to 8 b + 7, relative to the map's directory_origin and inside
  // its directory, into its slot unless it stands there already; its levels.
  const std::uint8_t* hold(std::int32_t bx, std::int32_t by, std::int32_t bz) noexcept;

 private:
  static constexpr std::uint32_t kNoKey = UINT32_MAX;
  static constexpr std::int32_t kNone = INT32_MIN;

  using BrickIndex = std::array<std::int32_t, 3>;

  bool near_cropped_side(const BrickIndex& brick) const noexcept;
  std::array<const std::uint8_t*, 27> values_around(const BrickIndex& brick) const noexcept;
  const std::uint8_t* values_of(const BrickIndex& brick) const noexcept;
  void decode(const BrickIndex& brick, std::uint8_t* levels) const noexcept;
  void decode_voxelwise(const BrickIndex& brick, std::uint8_t* levels) const noexcept;

  VoxmapView map_;
  std::array<std::uint32_t, 3> strides_{};
  bool keys_are_unique_ = false;
  // Box of the voxels that are known, relative to the directory; unbounded where nothing was cut.
  KnownBox known_;
  std::vector<std::uint32_t> keys_;
  std::vector<std::int32_t> tags_;
  std::vector<std::uint8_t> levels_;
};

}  // namespace forcelayer

// Levels around a point at one address: bricks of 8x8x8 voxels decoded with one voxel of halo, kept
// from frame to frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/field/brick_memo.h"

namespace forcelayer {

// One more than the level (runtime/field/level_field.h) of values 0 free, 1 interior, 2 surface, 3
// proximity, so that none is negative.
inline constexpr std::array<std::uint8_t, 4> kRaisedLevel{3, 0, 1, 2};

// A decoded brick holds 10 planes (x) of 8 rows (y) of 10 bytes (z); each byte holds the raised
// levels of three voxels along y, those at y-1, y and y+1 in bits 0, 2 and 4, with y running over
// the brick's own voxels and x and z over the halo too. So the 27 levels around voxel (x, y, z) of
// the brick are bytes z to z+2 of row y in planes x to x+2; reading byte z+3 along with them stays
// inside the row's bytes.
class LevelBricks : public BrickMemo {
 public:
  static constexpr std::uint32_t kRowBytes = 12;
  static constexpr std::uint32_t kPlaneBytes = 8 * kRowBytes;
  static constexpr std::uint32_t kBrickBytes = 10 * kPlaneBytes;

  // The map has two bits per voxel and outlives this.
  explicit LevelBricks(const Voxmap& voxmap);

  // Per slot kBrickBytes of raised levels.
  const std::uint8_t* levels() const { return levels_.data(); }

  // Decodes the brick of voxels 8 b to 8 b + 7, relative to the map's directory_origin and inside
  // its directory, into its slot unless it stands there already; its levels.
  const std::uint8_t* hold(std::int32_t bx, std::int32_t by, std::int32_t bz) noexcept;

 private:
  const std::uint8_t* values_of(const BrickIndex& brick) const noexcept;
  void decode(const BrickIndex& brick, std::uint8_t* levels) const noexcept;
  void decode_voxelwise(const BrickIndex& brick, std::uint8_t* levels) const noexcept;

  VoxmapView map_;
  std::vector<std::uint8_t> levels_;
};

}  // namespace forcelayer

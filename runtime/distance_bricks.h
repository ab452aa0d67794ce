// Distance codes around a point at one address: bricks of 4 or 8 bits decoded with one voxel of
// halo, kept from frame to frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/brick_memo.h"

namespace forcelayer {

// A decoded brick holds 10 planes (x) of 9 rows (y) of 10 pairs of bytes (z), x and z running over
// the brick and its halo, y over all of it but the last: a pair holds the codes at y and y + 1. So
// the codes at the corners of the cell whose lowest voxel is (x, y, z), each -1 to 7, are the four
// bytes from pair z + 1 of row y + 1 on in the planes x + 1 and x + 2.
class DistanceBricks : public BrickMemo {
 public:
  static constexpr std::uint32_t kRowBytes = 20;
  static constexpr std::uint32_t kPlaneBytes = 9 * kRowBytes;
  static constexpr std::uint32_t kBrickBytes = 10 * kPlaneBytes;

  // The map has 4 or 8 bits per voxel and outlives this.
  explicit DistanceBricks(const Voxmap& voxmap);

  // Per slot kBrickBytes of codes.
  const std::uint8_t* codes() const { return codes_.data(); }

  // Decodes the brick of voxels 8 b to 8 b + 7, relative to the map's directory_origin and inside
  // its directory, into its slot unless it stands there already; its codes.
  const std::uint8_t* hold(std::int32_t bx, std::int32_t by, std::int32_t bz) noexcept;

 private:
  // The brick and its halo, voxel by voxel: [x][y][z], each -1 to 8.
  using Halo = std::array<std::array<std::array<std::uint8_t, 10>, 10>, 10>;

  void gather(const BrickIndex& brick, Halo& halo) const noexcept;
  void gather_known(const BrickIndex& brick, Halo& halo) const noexcept;

  VoxmapView map_;
  std::uint32_t free_code_;
  std::vector<std::uint8_t> codes_;
};

}  // namespace forcelayer

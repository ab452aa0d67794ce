// Distance codes around a point at one address: bricks of 4 or 8 bits decoded with one voxel of
// halo, kept from frame to frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/brick_memo.h"

namespace forcelayer {

// A decoded brick holds the codes at the corners of cells, which lie between the centres of eight
// voxels: of those whose lowest voxel is the brick's. It has 8 planes (x) of 8 rows (y) of 9 words
// (z) of four bytes; byte 2 x' + y' of word z is the code at (x + x', y + y', z). So the codes at
// the corners of cell (x, y, z) are words z and z + 1 of row y of plane x.
class DistanceBricks : public BrickMemo {
 public:
  static constexpr std::uint32_t kRowBytes = 36;
  static constexpr std::uint32_t kPlaneBytes = 8 * kRowBytes;
  static constexpr std::uint32_t kBrickBytes = 8 * kPlaneBytes;

  // The map has 4 or 8 bits per voxel and outlives this.
  explicit DistanceBricks(const Voxmap& voxmap);

  // Per slot kBrickBytes of codes.
  const std::uint8_t* codes() const { return codes_.data(); }

  // Decodes the brick of voxels 8 b to 8 b + 7, relative to the map's directory_origin and inside
  // its directory or just before it (-1), into its slot unless it stands there already; its codes.
  const std::uint8_t* hold(std::int32_t bx, std::int32_t by, std::int32_t bz) noexcept;

  // Codes along z: eight of a brick, a byte each, and the one behind.
  struct Row {
    std::uint64_t own;
    std::uint32_t next;
  };

 private:
  // The brick and the voxels behind it, [x][y].
  using Halo = std::array<std::array<Row, 9>, 9>;

  void gather(const BrickIndex& brick, Halo& halo) const noexcept;
  void gather_known(const BrickIndex& brick, Halo& halo) const noexcept;

  VoxmapView map_;
  std::uint32_t free_code_;
  std::vector<std::uint8_t> codes_;
};

}  // namespace forcelayer

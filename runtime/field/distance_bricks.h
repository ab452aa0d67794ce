// Distance codes around a point in a few reads: bricks of 4 or 8 bits decoded with one voxel of
// halo, kept from frame to frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "runtime/field/brick_memo.h"

namespace forcelayer {

// A decoded brick holds the codes at the corners of cells, which lie between the centres of eight
// voxels: of all that touch one of the brick's centres. It has 9 planes (x) of 9 rows (y) of 10
// words (z) of four bytes, from the voxel before the brick on; byte 2 x' + y' of word z is the code
// at (x + x', y + y', z). So the codes at the corners of cell (x, y, z) are words z and z + 1 of
// row y of plane x, and those beside it a word, row or plane before or after.
class DistanceBricks : public BrickMemo {
 public:
  static constexpr std::uint32_t kRowBytes = 40;
  static constexpr std::uint32_t kPlaneBytes = 9 * kRowBytes;
  static constexpr std::uint32_t kBrickBytes = 9 * kPlaneBytes;
  // Where the cell of the brick's own first voxel and the seven behind it stands.
  static constexpr std::uint32_t kFirstBytes = kPlaneBytes + kRowBytes + 4;
  static constexpr std::uint32_t kMargin = 8;  // bytes that may be read beyond all bricks

  // The map has 4 or 8 bits per voxel and outlives this.
  explicit DistanceBricks(const Voxmap& voxmap);

  // Per slot kBrickBytes of codes.
  const std::uint8_t* codes() const { return codes_.data() + kMargin; }

  // Decodes the brick of voxels 8 b to 8 b + 7, relative to the map's directory_origin and inside
  // its directory, into its slot unless it stands there already; its codes.
  const std::uint8_t* hold(std::int32_t bx, std::int32_t by, std::int32_t bz) noexcept;

  // Codes along z, a byte each, from the one before the brick on.
  struct Row {
    std::uint64_t first;  // eight
    std::uint32_t last;   // two
  };

 private:
  // The brick and the voxels around it, [x][y].
  using Halo = std::array<std::array<Row, 10>, 10>;

  void gather(const BrickIndex& brick, Halo& halo) const noexcept;
  void gather_known(const BrickIndex& brick, Halo& halo) const noexcept;

  VoxmapView map_;
  std::uint32_t free_code_;
  std::vector<std::uint8_t> codes_;
};

}  // namespace forcelayer

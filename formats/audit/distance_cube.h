// Chebyshev distances of a node's cells from the nearest voxel that is not free. Internal to
// formats/audit/.
//
// The distance of a free cell from a neighbor that holds such a voxel is that neighbor's gap
// towards the cell, plus 1. A cell whose 26 neighbors are all free is one edge farther from
// everything than the nearest of its neighbors.
#pragma once

#include <algorithm>
#include <array>
#include <limits>

#include "formats/audit/neighborhoods.h"

namespace forcelayer::voxmap_audit {

inline constexpr std::int64_t kCells = 8;  // of a node, along an axis

constexpr std::int64_t flat(const Voxel& at, std::int64_t width) {
  return (at[0] * width + at[1]) * width + at[2];
}

using Distance = std::uint16_t;  // at most 8 cells of 64 voxels

// Distances of a node's cells, and of one layer of cells around it, from the node's own voxels that
// are not free: 0 for a cell that holds one, that cell's gap plus 1 for its neighbors, kFar
// elsewhere.
class Ring {
 public:
  static constexpr Distance kFar = std::numeric_limits<Distance>::max();
  static constexpr std::int64_t kWidth = kCells + 2;

  Ring() { cells_.fill(kFar); }

  // Cell n holds a voxel that is not free, and has these gaps.
  void add(std::uint32_t n, const Gaps& gaps) {
    const Voxel at = voxmap_walk::child_low({1, 1, 1}, n, 1);
    for (std::size_t d = 0; d < kDirections; ++d) {
      Distance& cell = cells_[static_cast<std::size_t>(flat(beside(at, d), kWidth))];
      const int distance = d == kCenter ? 0 : gaps[d] + 1;
      cell = std::min(cell, static_cast<Distance>(distance));
    }
  }

  const Distance* row(std::int64_t x, std::int64_t y) const {
    return cells_.data() + flat({x + 1, y + 1, 0}, kWidth);
  }

 private:
  std::array<Distance, kWidth * kWidth * kWidth> cells_;
};

// 8^3 cells and a margin of up to seven cells around them.
class DistanceCube {
 public:
  DistanceCube();

  // `margin` cells, at most kCells - 1.
  void clear(std::int64_t margin);

  // Takes in the ring of the node that lies in this direction.
  void add(const Ring& ring, std::size_t in_direction);

  // Repeats as often as the margin is wide: each distance becomes the least of itself and its
  // neighbors' plus `edge`. Cells at the border read cells that are not their neighbors. This error
  // moves inwards by one cell a step, so it stays in the margin and the middle is right.
  void spread(int edge);

  Distance at(std::uint32_t n) const {
    return cells_[static_cast<std::size_t>(
        kPad + flat({(n >> 6) + margin_, (n >> 3 & 7) + margin_, (n & 7) + margin_}, width_))];
  }

 private:
  static constexpr std::int64_t kMaxWidth = kCells + 2 * (kCells - 1);
  static constexpr std::int64_t kPad = kMaxWidth * kMaxWidth;
  using Cells = std::array<Distance, kMaxWidth * kMaxWidth * kMaxWidth + 2 * kPad>;

  Distance* row(std::int64_t x, std::int64_t y) {
    return cells_.data() + kPad + flat({x + margin_, y + margin_, margin_}, width_);
  }

  std::int64_t margin_ = 0, width_ = kCells;
  Cells cells_, one_, two_;
};

}  // namespace forcelayer::voxmap_audit

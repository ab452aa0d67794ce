// Drawing of small triangles, which most are: many at once, in 32-bit lanes.
//
// It marks exactly the voxels that TriangleOverlap finds, which is its slow twin.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "voxelize/node_canvas.h"

namespace forcelayer {

// Triangles whose corners lie in at most 8 voxels along every axis, some of them in the node. With
// 8 voxels, the normal is below 2^27 and 21 times its largest component fits 32 bits.
class SmallTriangles {
 public:
  static constexpr std::size_t kCapacity = 16;
  static constexpr std::int64_t kMaxVoxels = 8;

  bool full() const { return count_ == kCapacity; }

  // Corners in lattice units from the node's lowest corner.
  void add(const LatticeTriangle& corners) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t d = 0; d < 3; ++d) {
        corners_[k][d][count_] = static_cast<std::int32_t>(corners[k][d]);
      }
    }
    ++count_;
  }

  // Draws all that were added, and forgets them.
  void draw(NodeCanvas& canvas);

  using Lanes = std::array<std::int32_t, kCapacity>;
  using Corners = std::array<std::array<Lanes, 3>, 3>;  // [corner][axis][triangle]

 private:
  alignas(64) Corners corners_{};
  std::size_t count_ = 0;
};

}  // namespace forcelayer

// Drawing of small triangles, as most are: many at once, in 32-bit lanes. Its slow twin is
// TriangleOverlap, which finds the same voxels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "voxelize/scan/node_canvas.h"

namespace forcelayer::scan {

// Triangles whose corners lie in at most 8 voxels along every axis, some of them in the node. With
// 8 voxels, the normal is below 2^27 and 21 times its largest component fits 32 bits.
class SmallTriangles {
 public:
  static constexpr std::int64_t kMaxVoxels = 8;

  // Draws a triangle, or keeps it to be drawn with others of its size. Corners in lattice units
  // from the node's lowest corner, `low` and `high` the lowest and highest of their voxels.
  void draw(const lattice::LatticeTriangle& corners, const std::array<int, 3>& low,
            const std::array<int, 3>& high, NodeCanvas& canvas);

  // Draws all that were kept, and forgets them.
  void finish(NodeCanvas& canvas);

  static constexpr std::size_t kCapacity = 16;
  using Lanes = std::array<std::int32_t, kCapacity>;
  using Corners = std::array<std::array<Lanes, 3>, 3>;  // [corner][axis][triangle]
  struct Batch {
    alignas(64) Corners corners{};
    std::size_t count = 0;
  };

 private:
  void draw_batch(std::size_t number, NodeCanvas& canvas);

  std::array<Batch, 3> batches_;  // of at most 2, 4 and 8 voxels along every axis
};

}  // namespace forcelayer::scan

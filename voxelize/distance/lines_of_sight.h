// Which voxels a voxel's center sees: those to whose centers a straight line leads that no triangle
// crosses. So both centers lie on the same side of the surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "voxelize/distance/distance_kernel.h"

namespace forcelayer::distance {

class LinesOfSight {
 public:
  static constexpr int kFar = 2;  // voxels along each axis that a line leads at most
  static constexpr std::size_t kMaxLines = 24;
  using Offset = std::array<std::int8_t, 3>;  // from voxel to voxel

  // Forgets the lists of the node before.
  void begin_node() { of_8_.low = kNoCell; }

  // Begins with a voxel of the cell of 4^3 voxels at `low`. `around` holds every triangle within
  // kFar voxels along each axis of one of the cell's centers. It must outlive the lines of the
  // cell.
  void begin(const std::array<int, 3>& low, TriangleList around, const std::array<int, 3>& voxel);

  // As bits, the free lines of those to the voxels at `offsets`, kMaxLines at most. A line that
  // comes nearer than kKernelErrorVoxels to a triangle, or by rounding may, is not free.
  std::uint32_t free(std::span<const Offset> offsets);

 private:
  using List = std::vector<const PreparedTriangle*>;
  static constexpr std::array<int, 3> kNoCell{-1, -1, -1};

  // The triangles whose bounding boxes are within kFar of the centers of a cell.
  struct Cell {
    std::array<int, 3> low = kNoCell;
    List triangles;

    void pick(TriangleList from, const std::array<int, 3>& cell, int edge);
  };
  // The triangles whose bounding boxes are within so many voxels, 1 or 2, of the voxel's center.
  const List& within(int voxels);

  Cell of_8_, of_4_;
  std::array<std::vector<float>, 6> boxes_;  // of of_4_: lowest x, y, z, highest x, y, z
  std::array<int, 3> voxel_{};
  std::array<List, kFar> near_;  // within 1 voxel and within 2
  std::array<bool, kFar> is_listed_{};
  std::vector<std::uint8_t> marked_;
};

// Eight lines from one center. Lengths in lattice units.
struct EightLines {
  std::array<float, 3> from;
  alignas(64) float to_end[3][8];  // [axes][lines] from there to their ends
};

// The same as LinesOfSight::free() for the triangles of a list.
std::uint32_t free_lines(TriangleList triangles, const std::array<int, 3>& voxel,
                         std::span<const LinesOfSight::Offset> offsets);

}  // namespace forcelayer::distance

// Which voxels a triangle passes through, in exact integer arithmetic.
//
// Vertices lie on a lattice of 2^-10 voxel (snap()); a voxel is the half-open cube
// [i, i+1) x [j, j+1) x [k, k+1) in voxels, so that neighbors share no point and a face on voxel
// faces marks one layer. A voxel is hit where the triangle, borders included, has a point in it.
// Degenerate triangles are ordinary: they are the segment or the point that they cover.
//
// Method: the separating axes of triangle and box (Schwarz and Seidel 2010), for 512 cells at once.
// The open sides shrink a cell's reach along an axis by one integer step.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace forcelayer::lattice {

inline constexpr int kSnapBits = 10;
inline constexpr std::int64_t kSnapUnits = std::int64_t{1} << kSnapBits;  // lattice units a voxel

using LatticePoint = std::array<std::int64_t, 3>;     // units of 2^-10 voxel, |x| <= 2^62
using VoxelIndex = std::array<std::int64_t, 3>;       // voxels
using LatticeTriangle = std::array<LatticePoint, 3>;  // extents below 2^41 units (2^31 voxels)

// Nearest lattice point of `position_m` (ties to even). The voxel it falls into is floor(x / 2^10).
LatticePoint snap(const std::array<double, 3>& position_m, double voxel_size_m);

// 8x8x8 cells as bits: word x, bit y*8 + z. The order of OpenVDB's mask leaves and of .vox bricks.
struct alignas(64) BrickMask {
  std::array<std::uint64_t, 8> words{};

  bool test(unsigned x, unsigned y, unsigned z) const { return (words[x] >> (y * 8 + z) & 1) != 0; }
  bool any() const {
    std::uint64_t all = 0;
    for (const std::uint64_t word : words) all |= word;
    return all != 0;
  }
  bool operator==(const BrickMask&) const = default;
};

// Calls f(x, y, z), each 0..7, for every set bit of `mask`.
template <class F>
void for_each_cell(const BrickMask& mask, F&& f) {
  for (unsigned x = 0; x < 8; ++x) {
    for (std::uint64_t word = mask.words[x]; word != 0; word &= word - 1) {
      const auto bit = static_cast<unsigned>(std::countr_zero(word));
      f(x, bit >> 3, bit & 7);
    }
  }
}

// One triangle, set up for tests against many cells.
class TriangleOverlap {
 public:
  explicit TriangleOverlap(const LatticeTriangle& triangle);

  // Box of the voxels that hold the triangle's corners; both ends inclusive.
  const VoxelIndex& min_voxel() const { return min_voxel_; }
  const VoxelIndex& max_voxel() const { return max_voxel_; }

  // Whether the snapped triangle has no area.
  bool degenerate() const { return degenerate_; }

  // The hit ones of 8x8x8 half-open cells of 2^log2_cell voxels an edge (0 <= log2_cell <= 30), the
  // first of which has its lowest corner at voxel `corner` (any voxel, aligned or not).
  BrickMask cells(const VoxelIndex& corner, int log2_cell = 0) const;

 private:
  // A line bounding the triangle's projection: a (u - u0) + b (w - w0) >= 0 on the triangle's side.
  struct Edge {
    std::int64_t a = 0, b = 0;    // lattice units
    std::int64_t u0 = 0, w0 = 0;  // a point of the line, relative to low_
  };
  template <class Int>
  void set_up_edges(const LatticeTriangle& corners);
  template <class Base, class Lane>
  BrickMask tested_cells(const VoxelIndex& corner, int log2_cell) const;

  LatticePoint low_;                            // least coordinates of the corners
  VoxelIndex min_voxel_, max_voxel_;            // voxels of the least and greatest coordinates
  std::int64_t extent_ = 0;                     // largest side of the corners' box, units
  std::array<std::array<Edge, 3>, 3> edges_{};  // of the projections along x, y and z
  LatticePoint anchor_{};                       // corner 0, relative to low_
  LatticePoint side_1_{}, side_2_{};            // corners 1 and 2, relative to corner 0
  bool degenerate_ = true;
};

// Calls f(corner, mask) for every group of 8x8x8 cells of 2^log2_cell voxels that the triangle
// hits, once, with the hit ones; `corner` is the group's lowest voxel, a multiple of 8 cells. The
// work is proportional to the groups hit, whatever the extent.
template <class F>
void for_each_group(const TriangleOverlap& triangle, int log2_cell, F&& f);

// Every voxel that the triangle hits, each once.
std::vector<VoxelIndex> overlapped_voxels(const LatticeTriangle& triangle);

namespace detail {

template <class F>
void descend(const TriangleOverlap& triangle, const VoxelIndex& corner, int log2_cell,
             int log2_last, F& f) {
  const BrickMask hit = triangle.cells(corner, log2_cell);
  if (log2_cell == log2_last) {
    if (hit.any()) f(corner, hit);
    return;
  }
  for_each_cell(hit, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
    descend(
        triangle,
        {corner[0] + (x << log2_cell), corner[1] + (y << log2_cell), corner[2] + (z << log2_cell)},
        log2_cell - 3, log2_last, f);
  });
}

}  // namespace detail

template <class F>
void for_each_group(const TriangleOverlap& triangle, int log2_cell, F&& f) {
  // The smallest cells, each a group of the level below, of which eight in a row from an aligned
  // start cover the triangle's box.
  int log2_start = log2_cell + 3;
  VoxelIndex corner;
  for (;; log2_start += 3) {
    bool covered = true;
    for (std::size_t d = 0; d < 3; ++d) {
      corner[d] = triangle.min_voxel()[d] >> log2_start << log2_start;
      covered &= (triangle.max_voxel()[d] - corner[d]) >> log2_start < 8;
    }
    if (covered) break;
  }
  detail::descend(triangle, corner, log2_start, log2_cell, f);
}

}  // namespace forcelayer::lattice

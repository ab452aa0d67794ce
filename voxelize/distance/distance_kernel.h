// Distances of many points from many triangles, in vector lanes.
//
// The kernels compute in single precision on exact differences of lattice coordinates. Their error
// is below 1e-4 voxel for triangles of up to 200 voxels and points up to 64 voxels away.
// NearestTriangles gives the same bits wherever on the lattice the scene lies and for every vector
// width. squared_distances() adds steps from point to point, so its rounding may differ. It only
// decides which triangles are looked at.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "voxelize/distance/code_scale.h"
#include "voxelize/distance/prepared_triangle.h"

namespace forcelayer::distance {

// No distance that a kernel computes errs by more: ten times the bound above. The error of a stored
// code is twice that (kDistanceErrorVoxels of voxmap_format.h), as a writer may lose more.
inline constexpr float kKernelErrorVoxels = 1e-3f;

// Half the diagonal of the box around the voxel centers of a cube.
constexpr float half_diagonal(int edge_voxels) {
  return 0.8660255f * static_cast<float>(edge_voxels - 1);
}

using TriangleList = std::span<const PreparedTriangle* const>;

// 4 x 4 x 4 points `step` lattice units apart: point x*16 + y*4 + z at first + step (x, y, z).
struct PointCube {
  std::array<float, 3> first;
  float step;
};
inline constexpr std::size_t kCubePoints = 64;
using CubeValues = std::array<float, kCubePoints>;

// The squared distances of the points from each triangle, [triangles], and the least of each point.
void squared_distances(TriangleList triangles, const PointCube& points, CubeValues* squared,
                       CubeValues& smallest);

// For each triangle the points whose value is at most the limit, as bits: [count].
void bits_within(const CubeValues* values, std::size_t count, const CubeValues& limits,
                 std::uint64_t* bits);

// A cube of points has eight eighths of 2 x 2 x 2 points: the bits of eighth n = x*4 + y*2 + z.
constexpr std::uint64_t eighth(unsigned n) {
  return std::uint64_t{0x330033} << (32 * (n >> 2) + 8 * (n >> 1 & 1) + 2 * (n & 1));
}
inline constexpr std::size_t kEighths = 8;

// Eight cells. Lengths in lattice units. Eighth n = x*4 + y*2 + z.
struct EightCells {
  std::array<float, 3> first;  // the lowest cell's middle
  float step;                  // from one cell's middle to the next
  float around;  // the places that count are at most this far from their cell's middle
  float span;    // and along each axis at most this far
  std::array<float, kEighths> reach;  // farther triangles do not matter; negative: none does
};

// Which triangles may be the nearest to which eighths of a cell.
class NearEighths {
 public:
  // The centers of voxels in the eighths, of `edge` voxels, of the cell at voxel `low` of a node.
  // `reach` as in EightCells.
  void find(TriangleList triangles, const std::array<int, 3>& low, int edge,
            const std::array<float, kEighths>& reach);

  // As bits, the eighths in which triangle i of the list may be the nearest to a place, within the
  // reach. In every other eighth, and for every place within reach, another triangle is nearer by
  // more than kKernelErrorVoxels.
  unsigned eighths(std::size_t i) const { return bits_[i]; }

  const std::uint8_t* bits() const { return bits_.data(); }  // [triangles], and 8 zero bytes
  // The triangles nearest to the eighths' middles: numbers in the list, [eighths]. Their squared
  // distances from the outermost voxel centers of the eighth: [eighths][x][y][z].
  const std::uint32_t* nearest() const { return nearest_.data(); }
  const float* at_corners() const { return at_corner_.data(); }

 private:
  std::vector<float> scratch_;  // of near_eighths()
  std::vector<std::uint8_t> bits_;
  std::array<std::uint32_t, kEighths> nearest_;
  std::array<float, 8 * kEighths> at_corner_;
};

// The nearest triangle of each voxel's center in a cell of 4^3 voxels, and its squared distance.
class NearestTriangles {
 public:
  // Takes at least one triangle, and the cell's lowest voxel in its node. `reach` is for each
  // eighth of the cell the distance, in lattice units, up to which the result must be exact; a
  // negative reach asks for nothing. Beyond the reach least() is the squared distance of some
  // triangle, or 1e30.
  void find(TriangleList triangles, const std::array<int, 3>& low,
            const std::array<float, kEighths>& reach);

  const CubeValues& smallest() const { return min_; }
  // The number of the nearest triangle in the list. Of equally near ones it is the first by
  // lies_before(), so the list's order does not matter. Undefined where least() is 1e30. Reads the
  // list, which must still exist.
  std::uint32_t which(std::size_t point) const {
    const std::uint32_t number = which_[point];
    return (number & kTied) == 0 ? number : first_tied(point);
  }
  // The eighths in which triangle i of the list was measured (NearEighths).
  unsigned measured_in(std::size_t i) const { return near_.eighths(i); }

 private:
  static constexpr std::uint32_t kTied = std::uint32_t{1} << 31;

  std::uint32_t first_tied(std::size_t point) const;

  TriangleList triangles_;  // of the last find()
  PointCube cube_;
  NearEighths near_;
  CubeValues min_;
  std::array<std::uint32_t, kCubePoints> which_;
};

// The vector from the nearest point of a triangle to `point`, lattice units.
std::array<double, 3> offset_from(const PreparedTriangle& triangle,
                                  const std::array<double, 3>& point);

// The codes of voxels whose centers have these squared distances (lattice units): rounded down, and
// clamped to 0..255 beyond the ends of the scale. A set bit of `negative` makes the distance
// negative.
void codes_of_distances(const CubeValues& squared, std::uint64_t negative, const CodeScale& scale,
                        std::uint8_t* codes);

}  // namespace forcelayer::distance

// Distances of many points from many triangles, in vectors.
//
// Single precision on exact differences of lattice coordinates: below 1e-4 voxel of error for
// triangles of up to 200 voxels and points that are up to 64 away. What is found to be the least
// depends on the differences alone, so that it is the same wherever on the lattice the scene lies,
// and every width of vectors gives the same bits. How far triangles are from the middles of cells,
// which only decides what is looked at, goes by steps, which round differently.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "voxelize/distance/near_triangle.h"

namespace forcelayer {

struct DistanceScale;

inline constexpr float kDistanceErrorVoxels = 1e-3f;  // ten times what is ever seen

// Halves of the diagonal of the box of a cube's voxel centres.
constexpr float half_diagonal(int edge_voxels) {
  return 0.8660255f * static_cast<float>(edge_voxels - 1);
}

// Triangles that may matter to a cube of points.
using NearList = std::span<const NearTriangle* const>;

// 4 x 4 x 4 points `step` lattice units apart: point x*16 + y*4 + z at first + step (x, y, z).
struct PointCube {
  std::array<float, 3> first;
  float step;
};
inline constexpr std::size_t kCubePoints = 64;
using CubeValues = std::array<float, kCubePoints>;

// Squared distances, [triangles], for the middles of cells; `least` is the least of each point's.
void squared_distances(NearList triangles, const PointCube& points, CubeValues* squared,
                       CubeValues& least);

// Per triangle bits of the points whose value is at most the limit: [count].
void bits_within(const CubeValues* values, std::size_t count, const CubeValues& limits,
                 std::uint64_t* bits);

// A cube of points as eight of 2 x 2 x 2: bits of the points of number x*4 + y*2 + z.
constexpr std::uint64_t eighth(unsigned n) {
  return std::uint64_t{0x330033} << (32 * (n >> 2) + 8 * (n >> 1 & 1) + 2 * (n & 1));
}
inline constexpr std::size_t kEighths = 8;

// For the points of two cubes, the second behind the first along z: the least of each point's
// squared distances, and which of the triangles gives it.
class NearestTriangles {
 public:
  // At least one triangle. In the eighths of the cubes only triangles within `reach` lattice
  // units of one of its points matter, or none where that is negative; beyond, a least is that of
  // some triangles, or 1e30.
  void find(NearList triangles, const PointCube& first,
            const std::array<float, 2 * kEighths>& reach);

  const CubeValues& least(std::size_t cube) const { return least_[cube]; }
  // Of several that give it the one that lies before the others, so that their order in the list
  // does not matter. Undefined where the least is 1e30; reads the list.
  std::uint32_t which(std::size_t cube, std::size_t point) const {
    const std::uint32_t number = which_[cube][point];
    return (number & kTied) == 0 ? number : first_tied(cube, point);
  }

 private:
  static constexpr std::uint32_t kTied = std::uint32_t{1} << 31;

  std::uint32_t first_tied(std::size_t cube, std::size_t point) const;

  NearList triangles_;  // of the last find()
  PointCube first_;
  std::array<CubeValues, 2> least_;
  std::array<std::array<std::uint32_t, kCubePoints>, 2> which_;
  std::vector<float> squared_;         // [triangles][cubes][eighths] from their middles
  std::vector<std::uint8_t> eighths_;  // [cubes][triangles] bits of those that it matters to
};

// From the nearest point of a triangle to `point`, lattice units.
std::array<double, 3> way_from(const NearTriangle& triangle, const std::array<double, 3>& point);

// The codes of voxels whose centres have these squared distances, negative ones where the bit is
// set.
void codes_of_distances(const CubeValues& squared, std::uint64_t negative,
                        const DistanceScale& scale, std::uint8_t* codes);

}  // namespace forcelayer

// The nearest triangle to places on a path from a voxel's center, in doubles.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "voxelize/distance/distance_kernel.h"

namespace forcelayer::distance {

inline double length_of(const std::array<double, 3>& v) {
  return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

// Lengths in lattice units. The triangles that matter on a path are those that are less than kNear
// from its center. They are picked out once for cells of 8^3, of 4^3 voxels and of one voxel.
class NearPath {
 public:
  // How far a place may be from the center: so less than kNear that nothing in its way is missing.
  static constexpr double kFarthest = 2.3 * double{lattice::kSnapUnits},
                          kNear = 2.6 * double{lattice::kSnapUnits};

  // Forgets the lists of the node before.
  void begin_node() { of_8_.low = kNoCell; }

  // A path from a center in the cell of 4^3 voxels at `low`. `around` holds every triangle within
  // kNear of one of its centers.
  void begin(const std::array<int, 3>& low, TriangleList around);

  // The distance of the nearest triangle that is less than kNear from `center`, and the way from
  // it; of equally near ones the first in `around`. 1e300 where there is none.
  double nearest(const std::array<double, 3>& at, const std::array<double, 3>& center,
                 std::array<double, 3>& away);

 private:
  using List = std::vector<const PreparedTriangle*>;
  // Triangles, each in a sphere: columns, so that vectors hold several.
  struct SphereList {
    List triangles;
    std::vector<std::uint32_t> number;  // in of_4_
    std::vector<float> x, y, z, radius;

    void clear();
    void add(const PreparedTriangle* triangle, std::size_t in_cell);
  };
  static constexpr std::array<int, 3> kNoCell{-1, -1, -1};
  static constexpr int kBeyond = 2;  // voxels beyond the cell that a place can be in

  // How far a triangle is from a place where it was measured, on a path of that number.
  struct Measured {
    std::uint64_t path = 0;
    std::array<double, 3> at;
    double distance;
  };

  // The triangles whose bounding boxes are within kNear of a center in a cell.
  struct Cell {
    std::array<int, 3> low = kNoCell;
    List triangles;

    void pick(TriangleList from, const std::array<int, 3>& cell, int edge);
  };

  const SphereList& may_be_nearest(const std::array<double, 3>& at);
  void list_block(const std::array<int, 3>& low, std::array<SphereList, kEighths>& lists);
  void mark_spheres(const SphereList& list, const std::array<double, 3>& at, double distance);

  Cell of_8_, of_4_;
  // The place in blocks_ of each of the 4^3 blocks of 2^3 voxels in and around the cell, or -1.
  std::array<int, 64> block_;
  // The triangles that may be nearest in a voxel: [blocks][voxels].
  std::vector<std::array<SphereList, kEighths>> blocks_;
  int used_ = 0;
  std::uint64_t path_ = 0;                  // counts them
  std::vector<Measured> measured_;          // [of_4_]
  const PreparedTriangle* last_ = nullptr;  // that was nearest on this path
  std::vector<std::uint8_t> marked_;        // of a list: the spheres that are near enough
  NearEighths near_;
};

}  // namespace forcelayer::distance

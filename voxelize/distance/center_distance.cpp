#include "voxelize/distance/center_distance.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>

namespace forcelayer {
namespace {

__extension__ typedef __int128 Int128;
using WideInt = boost::multiprecision::int512_t;  // for triangles of up to 2^31 voxels

// The point of a triangle that is nearest to the origin is a corner, or lies on an edge or inside.
// Every distance is a quotient of integers, which is compared with the radius without dividing.
template <class Int>
class CenterTest {
 public:
  using Vec = std::array<Int, 3>;

  // Lattice units, from the voxel's centre.
  CenterTest(const std::array<LatticePoint, 3>& corners, std::int64_t radius_units)
      : radius2_(Int(radius_units) * radius_units) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t d = 0; d < 3; ++d) corners_[k][d] = corners[k][d];
    }
  }

  bool near() const {
    for (std::size_t k = 0; k < 3; ++k) {
      if (dot(corners_[k], corners_[k]) < radius2_) return true;
      if (edge_is_near(corners_[k], corners_[(k + 1) % 3])) return true;
    }
    return inside_is_near();
  }

 private:
  static Vec minus(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  static Int dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
  static Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }

  bool edge_is_near(const Vec& from, const Vec& to) const {
    const Vec along = minus(to, from);
    const Int t = -dot(from, along), length2 = dot(along, along);
    if (t <= 0 || t >= length2) return false;
    const Vec n = cross(from, along);
    return dot(n, n) < radius2_ * length2;
  }

  bool inside_is_near() const {
    const Vec n = cross(minus(corners_[1], corners_[0]), minus(corners_[2], corners_[0]));
    const Int n2 = dot(n, n);
    if (n2 == 0) return false;
    Int h = dot(n, corners_[0]);
    if (h < 0) h = -h;
    // h^2 < radius^2 n^2, whose square might not fit where h is far too large.
    if constexpr (std::is_same_v<Int, Int128>) {
      if (h >= Int{1} << 62) return false;
    }
    if (h * h >= radius2_ * n2) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec along = minus(corners_[(k + 1) % 3], corners_[k]);
      if (dot(cross(n, along), corners_[k]) > 0) return false;
    }
    return true;
  }

  std::array<Vec, 3> corners_;
  Int radius2_;
};

}  // namespace

bool center_is_nearer(const LatticeTriangle& triangle, const VoxelIndex& voxel,
                      std::int64_t radius_units) {
  std::array<LatticePoint, 3> corners;
  std::int64_t largest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t d = 0; d < 3; ++d) {
      corners[k][d] = triangle[k][d] - (voxel[d] << kSnapBits) - kSnapUnits / 2;
      largest = std::max(largest, std::abs(corners[k][d]));
    }
  }
  // Up to 2^20 units: edges up to 2^21, components of n up to 2^43, h below 2^65 (tested before it
  // is squared), radius^2 n^2 below 2^118, the sides of the inside test below 2^87.
  constexpr std::int64_t kLargest = std::int64_t{1} << 20;
  if (largest <= kLargest) return CenterTest<Int128>(corners, radius_units).near();
  return CenterTest<WideInt>(corners, radius_units).near();
}

}  // namespace forcelayer

#include "voxelize/cube_distance.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>

namespace forcelayer {
namespace {

__extension__ typedef __int128 Int128;
using WideInt = boost::multiprecision::int512_t;  // for triangles of up to 2^31 voxels

constexpr std::int64_t kEdge = kSnapUnits;

// The nearest pair of points of a cube and a triangle that do not cross is one of: a corner of the
// triangle and any point of the cube; an edge of the triangle and a corner or an edge of the cube;
// the inside of the triangle and a corner of the cube. Other pairs (faces of the cube, parallel
// edges) come as near only where one of these does. Every distance is a quotient of integers, which
// is compared with the radius without dividing.
template <class Int>
class CubeTest {
 public:
  using Vec = std::array<Int, 3>;

  // Lattice units, from the cube's lowest corner.
  CubeTest(const std::array<LatticePoint, 3>& corners, int radius_voxels) {
    const Int radius = Int(radius_voxels) * kEdge;
    radius2_ = radius * radius;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t d = 0; d < 3; ++d) corners_[k][d] = corners[k][d];
    }
  }

  bool near() const {
    for (const Vec& corner : corners_) {
      if (corner_is_near(corner)) return true;
    }
    for (std::size_t k = 0; k < 3; ++k) {
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

  bool corner_is_near(const Vec& corner) const {
    Int sum = 0;
    for (const Int& x : corner) {
      const Int gap = x < 0 ? Int(-x) : x > kEdge ? Int(x - kEdge) : Int(0);
      sum += gap * gap;
    }
    return sum < radius2_;
  }

  bool edge_is_near(const Vec& from, const Vec& to) const {
    const Vec along = minus(to, from);
    for (unsigned n = 0; n < 8; ++n) {
      const Vec corner{Int(n >> 2 & 1) * kEdge, Int(n >> 1 & 1) * kEdge, Int(n & 1) * kEdge};
      if (cube_corner_is_near(minus(corner, from), along)) return true;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (unsigned n = 0; n < 4; ++n) {
        if (cube_edge_is_near(from, along, axis, Int(n >> 1) * kEdge, Int(n & 1) * kEdge)) {
          return true;
        }
      }
    }
    return false;
  }

  // A corner of the cube, `w` from the edge's start, beside the edge.
  bool cube_corner_is_near(const Vec& w, const Vec& along) const {
    const Int t = dot(w, along), length2 = dot(along, along);
    if (t <= 0 || t >= length2) return false;
    const Vec n = cross(w, along);
    return dot(n, n) < radius2_ * length2;
  }

  // The cube's edge along `axis` at (u, v) on the other two axes.
  bool cube_edge_is_near(const Vec& from, const Vec& along, std::size_t axis, const Int& u,
                         const Int& v) const {
    const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
    const Int length2 = along[b] * along[b] + along[c] * along[c];
    const Int wu = u - from[b], wv = v - from[c];
    const Int t = wu * along[b] + wv * along[c];
    if (length2 == 0 || t < 0 || t > length2) return false;
    const Int at = from[axis] * length2 + t * along[axis];  // times length2
    if (at < 0 || at > Int(kEdge) * length2) return false;
    const Int n = wu * along[c] - wv * along[b];
    return n * n < radius2_ * length2;
  }

  // The inside of the triangle and the corner of the cube that is nearest to its plane.
  bool inside_is_near() const {
    const Vec n = cross(minus(corners_[1], corners_[0]), minus(corners_[2], corners_[0]));
    const Int n2 = dot(n, n);
    if (n2 == 0) return false;
    Int low = -dot(n, corners_[0]), high = low;  // of n . (x - corner 0) over the cube
    for (const Int& x : n) (x < 0 ? low : high) += x * kEdge;
    if (low < 0 && high > 0) return false;
    const bool above = low >= 0;
    const Int h = above ? low : Int(-high);
    // h^2 < radius^2 n^2, whose square might not fit where h is far too large.
    Int bound = radius2_ * n2;
    if constexpr (std::is_same_v<Int, Int128>) {
      if (h >= Int{1} << 62) return false;
    }
    if (h * h >= bound) return false;
    Vec corner;
    for (std::size_t d = 0; d < 3; ++d) corner[d] = (n[d] < 0) == above ? kEdge : 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec along = minus(corners_[(k + 1) % 3], corners_[k]);
      if (dot(cross(n, along), minus(corner, corners_[k])) < 0) return false;
    }
    return true;
  }

  std::array<Vec, 3> corners_;
  Int radius2_;
};

}  // namespace

bool comes_nearer(const LatticeTriangle& triangle, const VoxelIndex& voxel, int radius_voxels) {
  std::array<LatticePoint, 3> corners;
  std::int64_t largest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t d = 0; d < 3; ++d) {
      corners[k][d] = triangle[k][d] - (voxel[d] << kSnapBits);
      largest = std::max(largest, std::abs(corners[k][d]));
    }
  }
  // Up to 2^20 units: n below 2^43, h below 2^65 (tested before it is squared), radius^2 n^2 below
  // 2^118, the sides of an edge test below 2^88 2^30.
  constexpr std::int64_t kLargest = std::int64_t{1} << 20;
  if (largest <= kLargest) return CubeTest<Int128>(corners, radius_voxels).near();
  return CubeTest<WideInt>(corners, radius_voxels).near();
}

}  // namespace forcelayer

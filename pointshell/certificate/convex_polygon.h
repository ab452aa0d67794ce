// Convex polygons in space: triangles cut by planes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "pointshell/part/vec3.h"

namespace forcelayer::certificate {

// A convex polygon of at most 32 corners. A plane that would make more corners cuts nothing off.
class ConvexPolygon {
 public:
  ConvexPolygon() : count_(0) {}
  explicit ConvexPolygon(std::span<const part::Vec3> corners) : count_(corners.size()) {
    std::copy(corners.begin(), corners.end(), corners_);
  }

  void assign(const part::Vec3& a, const part::Vec3& b, const part::Vec3& c) {
    corners_[0] = a, corners_[1] = b, corners_[2] = c;
    count_ = 3;
  }

  // Keeps the part where dot(normal, x) <= offset. Where the polygon lies in that plane as a whole,
  // `keep_in_plane` decides. Returns whether anything was cut off.
  bool clip(const part::Vec3& normal, double offset, bool keep_in_plane);

  // Cuts the polygon in two: this polygon keeps the side that clip() would, `rest` gets the other.
  // False where it has too many corners to be cut; then both are whole.
  bool split(const part::Vec3& normal, double offset, ConvexPolygon& rest);

  bool empty() const { return count_ == 0; }
  std::span<const part::Vec3> corners() const { return {corners_, count_}; }
  double farthest_squared(const part::Vec3& from) const {
    double squared = 0;
    for (const part::Vec3& corner : corners())
      squared = std::max(squared, part::length_squared(corner - from));
    return squared;
  }

 private:
  static constexpr std::size_t kMaxCorners = 32;

  // Drops the corners on the positive side and adds those between the sides.
  bool cut(const double* side);

  // A union, so that a new polygon does not set all corners to zero.
  union {
    part::Vec3 corners_[kMaxCorners];
  };
  std::size_t count_;
};

// Inline, as the inner loop of cells and certificate.
inline bool ConvexPolygon::clip(const part::Vec3& normal, double offset, bool keep_in_plane) {
  double side[kMaxCorners];
  bool any_outside = false, any_inside = false;
  for (std::size_t n = 0; n < count_; ++n) {
    side[n] = part::dot(normal, corners_[n]) - offset;
    any_outside |= side[n] > 0;
    any_inside |= side[n] < 0;
  }
  if (!any_outside && (any_inside || keep_in_plane)) return false;
  if (!any_inside) {
    count_ = 0;
    return true;
  }
  return cut(side);
}

}  // namespace forcelayer::certificate

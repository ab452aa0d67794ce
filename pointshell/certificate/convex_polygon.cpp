#include "pointshell/certificate/convex_polygon.h"

namespace forcelayer::certificate {
namespace {

part::Vec3 crossing(const part::Vec3& a, const part::Vec3& b, double side_a, double side_b) {
  return a + (side_a / (side_a - side_b)) * (b - a);
}

}  // namespace

bool ConvexPolygon::cut(const double* side) {
  if (count_ == kMaxCorners) return false;
  // In place: at most one more corner is written than has been read, and that one is kept aside.
  const part::Vec3 first = corners_[0], last = corners_[count_ - 1];
  part::Vec3 previous = last, current = first;
  double previous_side = side[count_ - 1];
  std::size_t kept = 0;
  for (std::size_t n = 0; n < count_; ++n) {
    const part::Vec3 next = n + 1 < count_ ? corners_[n + 1] : first;
    if ((previous_side < 0 && side[n] > 0) || (previous_side > 0 && side[n] < 0)) {
      corners_[kept++] = crossing(previous, current, previous_side, side[n]);
    }
    if (side[n] <= 0) corners_[kept++] = current;
    previous = current;
    previous_side = side[n];
    current = next;
  }
  count_ = kept;
  return true;
}

bool ConvexPolygon::split(const part::Vec3& normal, double offset, ConvexPolygon& rest) {
  rest.count_ = count_;
  std::copy(corners_, corners_ + count_, rest.corners_);
  const bool rest_is_less = rest.clip(-normal, -offset, false);
  return clip(normal, offset, true) || rest_is_less;
}

}  // namespace forcelayer::certificate

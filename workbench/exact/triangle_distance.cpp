#include "workbench/exact/triangle_distance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <optional>
#include <utility>

namespace forcelayer::exact {
namespace {

using glm::cross;
using glm::dot;
using Vec = glm::dvec3;

// Where along a segment the place nearest to `p` is, from 0 to 1.
double nearest_fraction(const Vec& p, const Vec& from, const Vec& along) {
  const double square = dot(along, along);
  return square > 0 ? std::clamp(dot(p - from, along) / square, 0.0, 1.0) : 0;
}

// The nearest places of two segments. In nearly parallel ones the fraction of the first is known
// badly: by the angle a between them, in error by (rounding / a) where they are close. But there
// the distance changes by a times that only. Found from the cross product, not from the difference
// of products of lengths, which would cost half of the digits.
std::pair<Vec, Vec> nearest_of_segments(const Vec& a, const Vec& b, const Vec& c, const Vec& d) {
  const Vec along = b - a, across = d - c, normal = cross(along, across);
  const double square = dot(normal, normal);
  double s = 0.5;
  if (square > 0) s = std::clamp(dot(cross(c - a, across), normal) / square, 0.0, 1.0);
  const double t = nearest_fraction(a + s * along, c, across);
  const Vec second = c + t * across;
  return {a + nearest_fraction(second, a, along) * along, second};
}

// A triangle with unit vectors along its longest edge, along its height and along its normal. They
// are at right angles to each other however thin the triangle is. The height's direction is in
// error by (rounding / height), which moves no place within the height by more than the rounding.
class Face {
 public:
  explicit Face(const Corners& corners) {
    const auto square = [&](std::size_t n) {
      const Vec edge = corners[(n + 1) % 3] - corners[n];
      return dot(edge, edge);
    };
    std::size_t n = square(1) > square(0) ? 1 : 0;
    if (square(2) > square(n)) n = 2;
    origin_ = corners[n];
    edge_ = corners[(n + 1) % 3] - origin_;
    third_ = corners[(n + 2) % 3] - origin_;
    const double length = glm::length(edge_);
    if (!(length > 0)) return;
    along_ = edge_ / length;
    Vec height = third_ - dot(third_, along_) * along_;
    height -= dot(height, along_) * along_;
    height_ = glm::length(height);
    if (!(height_ > 0)) return;
    up_ = height / height_;
    normal_ = cross(along_, up_);
  }

  double off_plane(const Vec& p) const { return dot(p - origin_, normal_); }

  // The place straight below `p`; none where that lies outside of the triangle.
  std::optional<Vec> foot(const Vec& p) const {
    if (!(height_ > 0)) return std::nullopt;
    const Vec offset = p - origin_;
    const double of_third = dot(offset, up_) / height_;
    const double of_edge =
        (dot(offset, along_) - of_third * dot(third_, along_)) / dot(edge_, along_);
    if (!(of_third >= 0 && of_edge >= 0 && of_third + of_edge <= 1)) return std::nullopt;
    return origin_ + of_edge * edge_ + of_third * third_;
  }

  // Where a segment comes through.
  std::optional<Vec> crossing(const Vec& from, const Vec& to) const {
    const double before = off_plane(from), behind = off_plane(to);
    if ((before > 0) == (behind > 0) || !(height_ > 0)) return std::nullopt;
    const Vec place = from + before / (before - behind) * (to - from);
    return foot(place) ? std::optional(place) : std::nullopt;
  }

 private:
  Vec origin_, edge_, third_;
  Vec along_{0}, up_{0}, normal_{0};
  double height_ = 0;
};

}  // namespace

TriangleDistance triangle_distance(const Corners& first, const Corners& second) {
  const Face of_first(first), of_second(second);
  TriangleDistance smallest;
  double min_square = std::numeric_limits<double>::infinity();
  const auto take = [&](const Vec& p, const Vec& q) {
    const double square = dot(p - q, p - q);
    if (square >= min_square) return;
    min_square = square;
    smallest.first_m = p;
    smallest.second_m = q;
  };
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec &a = first[n], &b = first[(n + 1) % 3], &c = second[n], &d = second[(n + 1) % 3];
    if (const auto place = of_second.crossing(a, b)) return {0, *place, *place};
    if (const auto place = of_first.crossing(c, d)) return {0, *place, *place};
    if (const auto foot = of_second.foot(a)) take(a, *foot);
    if (const auto foot = of_first.foot(c)) take(*foot, c);
    for (std::size_t m = 0; m < 3; ++m) {
      const auto [p, q] = nearest_of_segments(a, b, second[m], second[(m + 1) % 3]);
      take(p, q);
    }
  }
  smallest.distance_m = std::sqrt(min_square);
  return smallest;
}

}  // namespace forcelayer::exact

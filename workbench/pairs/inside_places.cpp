#include "workbench/pairs/inside_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "workbench/pairs/near_boxes.h"

namespace forcelayer::pairs {
namespace {

using exact::Body;
using part::Piece;
using part::Vec3;

// An open mesh may hold a place around which it winds more than this. In the opening of a box
// without one face it winds a half.
constexpr double kMayHold = 0.25;
// How many triangles place_inside() looks at.
constexpr std::size_t kMaxTriangles = 1024;

double diagonal_of(const mesh::Box& box) {
  double squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    squared += (box.high[axis] - box.low[axis]) * (box.high[axis] - box.low[axis]);
  }
  return std::sqrt(squared);
}

bool is_in(const mesh::Box& box, const Vec3& p) {
  return p.x >= box.low[0] && p.x <= box.high[0] && p.y >= box.low[1] && p.y <= box.high[1] &&
         p.z >= box.low[2] && p.z <= box.high[2];
}

// The middle of the box in which two boxes overlap.
Vec3 middle_of_both(const mesh::Box& a, const mesh::Box& b) {
  std::array<double, 3> middle{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    middle[axis] = (std::max(a.low[axis], b.low[axis]) + std::min(a.high[axis], b.high[axis])) / 2;
  }
  return {middle[0], middle[1], middle[2]};
}

double coordinate(const Vec3& p, std::size_t axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

// The corners of that part of a triangle which lies in a box.
std::vector<Vec3> clipped(const Piece& triangle, const mesh::Box& box) {
  std::vector<Vec3> corners(triangle.begin(), triangle.end());
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const double side : {1.0, -1.0}) {
      const double bound = side > 0 ? box.high[axis] : -box.low[axis];
      const auto outside_m = [&](const Vec3& p) { return side * coordinate(p, axis) - bound; };
      std::vector<Vec3> kept;
      for (std::size_t n = 0; n < corners.size(); ++n) {
        const Vec3 &from = corners[n], &to = corners[(n + 1) % corners.size()];
        const double a = outside_m(from), b = outside_m(to);
        if (a <= 0) kept.push_back(from);
        if ((a < 0 && b > 0) || (a > 0 && b < 0)) kept.push_back(from + a / (a - b) * (to - from));
      }
      corners = std::move(kept);
    }
  }
  return corners;
}

// Places of a polygon: its corners, the middles of its edges, and its middle.
std::vector<Vec3> places_of(const std::vector<Vec3>& corners) {
  std::vector<Vec3> places;
  Vec3 sum{0, 0, 0};
  for (std::size_t n = 0; n < corners.size(); ++n) {
    places.push_back(corners[n]);
    places.push_back(0.5 * (corners[n] + corners[(n + 1) % corners.size()]));
    sum = sum + corners[n];
  }
  if (!corners.empty()) places.push_back(1.0 / static_cast<double>(corners.size()) * sum);
  return places;
}

mesh::Box box_of(const Piece& triangle) {
  mesh::Box box = mesh::empty_box();
  for (const Vec3& p : triangle) mesh::extend(box, mesh::Vec3d{p.x, p.y, p.z});
  return box;
}

}  // namespace

bool may_hold(const Shape& shape, const Vec3& place_m) {
  const Body& body = *shape.body();
  return body.is_solid() ? body.holds(place_m) : std::abs(body.winding(place_m)) > kMayHold;
}

std::optional<Vec3> place_inside(const Shape& inner, const Shape& outer, double beyond_m) {
  const part::Part& part = inner.body()->tree().part();
  std::vector<std::size_t> near;
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    const mesh::Box box = box_of(part::triangle_piece(part, t));
    if (distance_of(box, outer.box_m()) == 0) near.push_back(t);
  }
  const std::size_t step = 1 + near.size() / kMaxTriangles;
  for (std::size_t n = 0; n < near.size(); n += step) {
    const Piece triangle = part::triangle_piece(part, near[n]);
    for (const Vec3& place : places_of(clipped(triangle, outer.box_m()))) {
      if (outer.body()->tree().is_within(place, beyond_m)) continue;
      if (may_hold(outer, place)) return place;
    }
  }
  return std::nullopt;
}

Ball ball_in_both(const Shape& first, const Shape& second, double min_m) {
  constexpr std::size_t kTriangles = 24;
  constexpr int kDepths = 12;
  const Body &own = *first.body(), &other = *second.body();
  const part::Part& part = own.tree().part();
  std::vector<std::pair<double, std::size_t>> largest;  // doubled areas
  for (std::size_t t = 0; t < part.triangles.size(); ++t) {
    largest.emplace_back(-part::length(part::doubled_area_normal(part, t)), t);
  }
  const std::size_t count = std::min(kTriangles, largest.size());
  std::partial_sort(largest.begin(), largest.begin() + static_cast<std::ptrdiff_t>(count),
                    largest.end());
  Ball best;
  const auto try_place = [&](const Vec3& place) {
    if (!is_in(first.box_m(), place) || !is_in(second.box_m(), place)) return;
    const double radius_m = std::sqrt(std::min(own.tree().nearest(place).distance_squared,
                                               other.tree().nearest(place).distance_squared));
    const double cracks_m = own.crack_near_m(place, radius_m) + other.crack_near_m(place, radius_m);
    if (radius_m <= std::max(best.radius_m, min_m + cracks_m)) return;
    if (may_hold(first, place) && may_hold(second, place)) best = {place, radius_m};
  };
  try_place(middle_of_both(first.box_m(), second.box_m()));
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t t = largest[n].second;
    const Vec3 inwards = -own.outward() * part::normalized(part::doubled_area_normal(part, t));
    double depth_m = diagonal_of(first.box_m());
    for (int k = 0; k < kDepths && depth_m > 2 * best.radius_m; ++k) {
      depth_m /= 2;
      try_place(part::centroid(part::triangle_piece(part, t)) + depth_m * inwards);
    }
  }
  return best;
}

}  // namespace forcelayer::pairs

#include "pointshell/normals.h"

#include <algorithm>
#include <cmath>

#include "pointshell/parallel.h"

namespace forcelayer {
namespace {

constexpr double kFullCos = 0.8660254037844387;  // 30 degrees
constexpr double kNoneCos = 0.5;                 // 60 degrees
// Triangles whose distance from the point exceeds the nearest one's by less than this share of the
// radius meet at the point: more than the rounding of positions to floats.
constexpr double kSamePlace = 1e-4;

struct Point2 {
  double x, y;
};

double cross2(const Point2& a, const Point2& b) { return a.x * b.y - a.y * b.x; }
double dot2(const Point2& a, const Point2& b) { return a.x * b.x + a.y * b.y; }

// Signed area of the circular sector between the directions of a and b.
double sector(const Point2& a, const Point2& b, double radius) {
  return 0.5 * radius * radius * std::atan2(cross2(a, b), dot2(a, b));
}

// Signed area of the triangle (origin, a, b) within the circle of this radius about the origin.
double wedge_in_circle(const Point2& a, const Point2& b, double radius) {
  const Point2 d{b.x - a.x, b.y - a.y};
  const double dd = dot2(d, d), ad = dot2(a, d);
  const double discriminant = ad * ad - dd * (dot2(a, a) - radius * radius);
  if (dd == 0) return 0;
  if (discriminant <= 0) return sector(a, b, radius);
  // The chord's ends, as shares of the way from a to b.
  const double root = std::sqrt(discriminant);
  const double enter = std::max((-ad - root) / dd, 0.0), leave = std::min((-ad + root) / dd, 1.0);
  if (enter >= leave) return sector(a, b, radius);
  const Point2 p{a.x + enter * d.x, a.y + enter * d.y}, q{a.x + leave * d.x, a.y + leave * d.y};
  return (enter > 0 ? sector(a, p, radius) : 0) + 0.5 * cross2(p, q) +
         (leave < 1 ? sector(q, b, radius) : 0);
}

double range_weight(double cosine) {
  return std::clamp((cosine - kNoneCos) / (kFullCos - kNoneCos), 0.0, 1.0);
}

double angle_between(const Vec3& u, const Vec3& v) {
  return std::atan2(length(cross(u, v)), dot(u, v));
}

// The angle that a triangle fills around a point of it: pi for a point on a side, less at a corner.
// A point inside counts as on a side: then it is the only triangle, or one of several in one plane.
double angle_at(const Vec3& place, const std::array<Vec3, 3>& corners, double same_place) {
  for (int n = 0; n < 3; ++n) {
    if (length(place - corners[n]) <= same_place) {
      return angle_between(corners[(n + 1) % 3] - corners[n], corners[(n + 2) % 3] - corners[n]);
    }
  }
  return std::acos(-1.0);
}

class NormalFinder {
 public:
  NormalFinder(const TriangleTree& tree, double radius)
      : tree_(tree), part_(tree.part()), radius_(radius) {}

  void find(const Vec3& point, Vec3& inward, double& cone_cos) const {
    const SurfacePoint foot = tree_.nearest(point).point;
    const Vec3 seed = seed_at(foot);
    Vec3 sum;
    tree_.visit_near(foot.position, radius_, [&](std::uint32_t t) {
      const Vec3 normal = normalized(doubled_area_normal(part_, t));
      const double weight = range_weight(dot(normal, seed));
      if (weight > 0) sum += weight * area_near(foot.position, t) * normal;
    });
    const Vec3 outward = length_squared(sum) > 0 ? normalized(sum) : seed;
    inward = -outward;
    cone_cos = cone_about(foot.position, outward);
  }

 private:
  std::array<Vec3, 3> corners(std::uint32_t t) const {
    const Triangle& c = part_.triangles[t];
    return {part_.vertices[c[0]], part_.vertices[c[1]], part_.vertices[c[2]]};
  }

  double area_near(const Vec3& place, std::uint32_t t) const {
    const auto c = corners(t);
    return area_within_ball(place, radius_, c[0], c[1], c[2]);
  }

  Vec3 seed_at(const SurfacePoint& foot) const {
    const double same_place = kSamePlace * radius_;
    Vec3 sum;
    tree_.visit_near(foot.position, same_place, [&](std::uint32_t t) {
      const auto c = corners(t);
      const Vec3 nearest = nearest_on_triangle(foot.position, c[0], c[1], c[2]);
      if (length_squared(nearest - foot.position) > same_place * same_place) return;
      sum += angle_at(nearest, c, same_place) * normalized(doubled_area_normal(part_, t));
    });
    // Faces back to back cancel: then the triangle that the point was found on decides.
    if (length(sum) > 1e-3) return normalized(sum);
    return nearest_area_normal(foot);
  }

  // The normal of the foot's triangle or, where that has no area, of the nearest one that has.
  Vec3 nearest_area_normal(const SurfacePoint& foot) const {
    const Vec3 normal = normalized(doubled_area_normal(part_, foot.triangle));
    if (length_squared(normal) > 0) return normal;
    for (double reach = kSamePlace * radius_;; reach *= 4) {
      Vec3 best;
      double best_squared = reach * reach;
      tree_.visit_near(foot.position, reach, [&](std::uint32_t t) {
        const auto c = corners(t);
        const Vec3 candidate = normalized(doubled_area_normal(part_, t));
        const double squared =
            length_squared(nearest_on_triangle(foot.position, c[0], c[1], c[2]) - foot.position);
        if (length_squared(candidate) == 0 || squared > best_squared) return;
        best = candidate;
        best_squared = squared;
      });
      if (length_squared(best) > 0) return best;
    }
  }

  double cone_about(const Vec3& place, const Vec3& outward) const {
    double cosine = 1;
    tree_.visit_near(place, radius_, [&](std::uint32_t t) {
      const double c = dot(normalized(doubled_area_normal(part_, t)), outward);
      if (c < cosine && area_near(place, t) > 0) cosine = c;
    });
    return std::max(cosine, -1.0);
  }

  const TriangleTree& tree_;
  const Part& part_;
  const double radius_;
};

}  // namespace

double area_within_ball(const Vec3& centre, double radius, const Vec3& a, const Vec3& b,
                        const Vec3& c) {
  const Vec3 doubled = cross(b - a, c - a);
  const double norm = length(doubled);
  if (norm == 0) return 0;
  const Vec3 normal = (1 / norm) * doubled;
  const double height = dot(a - centre, normal);
  if (std::abs(height) >= radius) return 0;
  const double reach = radius * radius;
  if (std::max({length_squared(a - centre), length_squared(b - centre),
                length_squared(c - centre)}) <= reach) {
    return norm / 2;
  }
  const Vec3 along_x = normalized(b - a), along_y = cross(normal, along_x);
  const Vec3 foot = centre + height * normal;
  const auto flat = [&](const Vec3& p) {
    return Point2{dot(p - foot, along_x), dot(p - foot, along_y)};
  };
  const double circle = std::sqrt(reach - height * height);
  const Point2 pa = flat(a), pb = flat(b), pc = flat(c);
  const double area = wedge_in_circle(pa, pb, circle) + wedge_in_circle(pb, pc, circle) +
                      wedge_in_circle(pc, pa, circle);
  return std::max(area, 0.0);
}

ShellNormals shell_normals(const TriangleTree& tree, std::span<const Vec3> points, double radius) {
  ShellNormals normals;
  normals.inward.resize(points.size());
  normals.cone_cos.resize(points.size());
  const NormalFinder finder(tree, radius);
  parallel_for_each_index(points.size(), 256, [&](std::size_t n) {
    finder.find(points[n], normals.inward[n], normals.cone_cos[n]);
  });
  return normals;
}

}  // namespace forcelayer

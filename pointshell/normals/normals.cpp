#include "pointshell/normals/normals.h"

#include <algorithm>
#include <cmath>

#include "pointshell/part/parallel.h"
#include "pointshell/part/pieces.h"

namespace forcelayer::normals {
namespace {

constexpr double kFullCos = 0.8660254037844387;  // 30 degrees
constexpr double kNoneCos = 0.5;                 // 60 degrees
// In radii. Triangles this close to the foot meet there; it is more than the rounding of positions
// to floats.
constexpr double kSamePlace = 1e-4;
constexpr double kCanceled = 1e-3;      // normals whose sum is shorter cancel each other
constexpr double kFlatCos = 1 - 1e-12;  // one direction but for rounding

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
  // The chord's ends, as fractions of the way from a to b.
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

double angle_between(const part::Vec3& u, const part::Vec3& v) {
  return std::atan2(part::length(part::cross(u, v)), part::dot(u, v));
}

// The angle of a triangle around a point of it: pi for a point on a side, less at a corner. A point
// inside counts as on a side, for then only triangles of one plane meet there.
double angle_at(const part::Vec3& place, const part::Piece& corners, double same_place) {
  for (int n = 0; n < 3; ++n) {
    if (part::length(place - corners[n]) <= same_place) {
      return angle_between(corners[(n + 1) % 3] - corners[n], corners[(n + 2) % 3] - corners[n]);
    }
  }
  return std::acos(-1.0);
}

// Finds the normals of points one by one; one of it per task, as it keeps scratch memory.
class NormalFinder {
 public:
  NormalFinder(const part::TriangleTree& tree, double radius, const std::vector<bool>& of_sheet,
               const std::vector<bool>& flat)
      : tree_(tree), part_(tree.part()), radius_(radius), of_sheet_(of_sheet), flat_(flat) {}

  // Fills element n. `near` holds at least the triangles within kReach radii of `point`.
  void find(const part::Vec3& point, std::span<const std::uint32_t> near, std::size_t n,
            ShellNormals& normals) {
    const part::SurfacePoint foot = tree_.nearest(point, near);
    const double listed_reach = (sample::RestrictedCells::kReach - 1) * radius_ * (1 - 1e-9);
    const bool listed = part::length(point - foot.position) <= listed_reach;
    gather(foot.position, listed ? near : triangles_near(foot.position));
    const part::Vec3 seed = seed_at(foot);
    const part::Vec3 outward = smoothed(foot.position, seed);
    normals.inward[n] = -outward;
    normals.two_sided[n] = is_on_sheet(foot) ? 1 : 0;
    normals.cone_cos[n] = normals.two_sided[n] ? -1 : cone_about(foot.position, outward);
  }

 private:
  struct Face {
    part::Piece corners;
    part::Vec3 normal;  // unit, or zero where the triangle is flat
    bool of_sheet;
    double area = -1;  // of it within the radius of the foot; negative: not yet known
  };

  part::Vec3 normal_of(std::uint32_t t) const {
    return flat_[t] ? part::Vec3{} : part::normalized(part::doubled_area_normal(part_, t));
  }

  std::span<const std::uint32_t> triangles_near(const part::Vec3& place) {
    triangles_.clear();
    tree_.visit_near(place, radius_, [&](std::uint32_t t) { triangles_.push_back(t); });
    return triangles_;
  }

  void gather(const part::Vec3& foot, std::span<const std::uint32_t> triangles) {
    faces_.clear();
    for (const std::uint32_t t : triangles) {
      const part::Piece corners = part::triangle_piece(part_, t);
      const part::Vec3 normal = normal_of(t);
      if (std::abs(part::dot(normal, foot - corners[0])) < radius_) {
        faces_.push_back({corners, normal, of_sheet_[t]});
      }
    }
  }

  // Calls visit(face, place) for the faces that pass through `foot`, at their nearest place.
  template <typename Visit>
  void visit_faces_at(const part::Vec3& foot, const Visit& visit) const {
    const double same_place = kSamePlace * radius_;
    for (const Face& face : faces_) {
      if (std::abs(part::dot(face.normal, foot - face.corners[0])) > same_place) continue;
      const part::Vec3 nearest =
          part::nearest_on_triangle(foot, face.corners[0], face.corners[1], face.corners[2]);
      if (part::length_squared(nearest - foot) > same_place * same_place) continue;
      visit(face, nearest);
    }
  }

  bool is_on_sheet(const part::SurfacePoint& foot) const {
    bool found = of_sheet_[foot.triangle];
    visit_faces_at(foot.position,
                   [&](const Face& face, const part::Vec3&) { found = found || face.of_sheet; });
    return found;
  }

  part::Vec3 seed_at(const part::SurfacePoint& foot) const {
    part::Vec3 sum;
    visit_faces_at(foot.position, [&](const Face& face, const part::Vec3& place) {
      sum += angle_at(place, face.corners, kSamePlace * radius_) * face.normal;
    });
    // Faces back to back cancel; then the triangle of the foot decides.
    if (part::length(sum) > kCanceled) return part::normalized(sum);
    return nearest_area_normal(foot);
  }

  // The normal of the foot's triangle or, where that is flat, of the nearest one that is not.
  part::Vec3 nearest_area_normal(const part::SurfacePoint& foot) const {
    const part::Vec3 own = normal_of(foot.triangle);
    if (part::length_squared(own) > 0) return own;
    for (double reach = kSamePlace * radius_;; reach *= 4) {
      part::Vec3 best;
      double best_squared = reach * reach;
      tree_.visit_near(foot.position, reach, [&](std::uint32_t t) {
        const part::Piece corners = part::triangle_piece(part_, t);
        const part::Vec3 normal = normal_of(t);
        const part::Vec3 nearest =
            part::nearest_on_triangle(foot.position, corners[0], corners[1], corners[2]);
        const double squared = part::length_squared(nearest - foot.position);
        if (part::length_squared(normal) == 0 || squared > best_squared) return;
        best = normal;
        best_squared = squared;
      });
      if (part::length_squared(best) > 0) return best;
    }
  }

  part::Vec3 smoothed(const part::Vec3& place, const part::Vec3& seed) {
    // A flat neighborhood needs no areas.
    const bool flat = std::all_of(faces_.begin(), faces_.end(), [&](const Face& face) {
      const double cosine = part::dot(face.normal, seed);
      return cosine <= kNoneCos || cosine >= kFlatCos;
    });
    if (flat) return seed;
    part::Vec3 sum;
    for (Face& face : faces_) {
      const double weight = range_weight(part::dot(face.normal, seed));
      if (weight > 0) sum += weight * area_near(place, face) * face.normal;
    }
    return part::length_squared(sum) > 0 ? part::normalized(sum) : seed;
  }

  double cone_about(const part::Vec3& place, const part::Vec3& outward) const {
    double cosine = 1;
    for (const Face& face : faces_) {
      if (part::length_squared(face.normal) == 0) continue;
      const double c = part::dot(face.normal, outward);
      if (c < cosine && is_within_radius(place, face)) cosine = c;
    }
    return std::max(cosine, -1.0);
  }

  // By its nearest place, because the area of a corner that just reaches in is lost to rounding.
  bool is_within_radius(const part::Vec3& place, const Face& face) const {
    const auto& [a, b, c] = face.corners;
    return part::length_squared(part::nearest_on_triangle(place, a, b, c) - place) <=
           radius_ * radius_;
  }

  double area_near(const part::Vec3& place, Face& face) const {
    if (face.area < 0) {
      face.area =
          area_within_ball(place, radius_, face.corners[0], face.corners[1], face.corners[2]);
    }
    return face.area;
  }

  const part::TriangleTree& tree_;
  const part::Part& part_;
  const double radius_;
  const std::vector<bool>&of_sheet_, &flat_;  // [triangle]
  std::vector<std::uint32_t> triangles_;
  std::vector<Face> faces_;  // near the foot
};

}  // namespace

double area_within_ball(const part::Vec3& center, double radius, const part::Vec3& a,
                        const part::Vec3& b, const part::Vec3& c) {
  const part::Vec3 doubled = part::cross(b - a, c - a);
  const double norm = part::length(doubled);
  if (norm == 0) return 0;
  const part::Vec3 normal = (1 / norm) * doubled;
  const double height = part::dot(a - center, normal);
  if (std::abs(height) >= radius) return 0;
  const double reach = radius * radius;
  if (std::max({part::length_squared(a - center), part::length_squared(b - center),
                part::length_squared(c - center)}) <= reach) {
    return norm / 2;
  }
  const part::Vec3 along_x = part::normalized(b - a), along_y = part::cross(normal, along_x);
  const part::Vec3 foot = center + height * normal;
  const auto flat = [&](const part::Vec3& p) {
    return Point2{part::dot(p - foot, along_x), part::dot(p - foot, along_y)};
  };
  const double circle = std::sqrt(reach - height * height);
  const Point2 pa = flat(a), pb = flat(b), pc = flat(c);
  const double area = wedge_in_circle(pa, pb, circle) + wedge_in_circle(pb, pc, circle) +
                      wedge_in_circle(pc, pa, circle);
  return std::max(area, 0.0);
}

ShellNormals shell_normals(const sample::RestrictedCells& cells, std::span<const part::Vec3> points,
                           double radius, const std::vector<bool>& of_sheet) {
  ShellNormals normals;
  normals.inward.resize(points.size());
  normals.cone_cos.resize(points.size());
  normals.two_sided.resize(points.size());
  const part::Part& part = cells.tree().part();
  std::vector<bool> flat(part.triangles.size());
  for (std::size_t t = 0; t < flat.size(); ++t)
    flat[t] = part::is_flat(part::triangle_piece(part, t));
  part::parallel_ranges(points.size(), 256, [&](std::size_t begin, std::size_t end) {
    NormalFinder finder(cells.tree(), radius, of_sheet, flat);
    for (std::size_t n = begin; n < end; ++n) {
      finder.find(points[n], cells.triangles_near(n), n, normals);
    }
  });
  return normals;
}

}  // namespace forcelayer::normals

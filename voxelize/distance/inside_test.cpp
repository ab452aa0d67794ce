#include "voxelize/distance/inside_test.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace forcelayer::distance {
namespace {

using Vec = std::array<double, 3>;
using Corners = std::array<Vec, 3>;

// A point this near to a triangle, in lattice units, is on it: the nearest point is computed to
// some thousandths of a unit.
constexpr double kOnIt = 0.25;

Vec minus(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
double dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
double length(const Vec& a) { return std::sqrt(dot(a, a)); }
Vec scaled(const Vec& a, double factor) { return {factor * a[0], factor * a[1], factor * a[2]}; }

// How far a point is from a segment from the origin to `end`.
double off_segment(const Vec& end, const Vec& p) {
  const double squared = dot(end, end);
  const double fraction = squared > 0 ? std::clamp(dot(p, end) / squared, 0.0, 1.0) : 0.0;
  return length(minus(p, scaled(end, fraction)));
}

// The angle that a triangle fills around a point of its plane, times its unit normal: 2 pi inside
// of it, pi on an edge, its own at a corner. 0 where the point is not on it.
Vec weighted_normal(const Corners& t, const Vec& p) {
  Vec normal = cross(minus(t[1], t[0]), minus(t[2], t[0]));
  const double twice_area = length(normal);
  if (!(twice_area > 0)) return {};
  normal = scaled(normal, 1 / twice_area);
  if (std::abs(dot(minus(p, t[0]), normal)) > kOnIt) return {};
  double angle = 2 * std::numbers::pi;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec &a = t[k], &b = t[(k + 1) % 3], &c = t[(k + 2) % 3];
    if (length(minus(p, a)) <= kOnIt) {
      const Vec to_b = minus(b, a), to_c = minus(c, a);
      return scaled(normal, std::atan2(length(cross(to_b, to_c)), dot(to_b, to_c)));
    }
    if (off_segment(minus(b, a), minus(p, a)) <= kOnIt) {
      angle = std::min(angle, std::numbers::pi);
    } else if (dot(cross(normal, minus(b, a)), minus(p, a)) < 0) {
      angle = 0;  // beyond this edge, unless the point is at a corner
    }
  }
  return scaled(normal, angle);
}

std::array<float, 3> rounded(const Vec& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

// Whether a point may be within `reach` of a triangle, by its bounding box.
inline bool may_reach(const PreparedTriangle& t, const std::array<float, 3>& p, float reach) {
  for (std::size_t d = 0; d < 3; ++d) {
    const float at = p[d] - t.corner[d];
    if (at < std::min({0.0f, t.edge_1[d], t.edge_2[d]}) - reach) return false;
    if (at > std::max({0.0f, t.edge_1[d], t.edge_2[d]}) + reach) return false;
  }
  return true;
}

bool are_of_one(const PreparedTriangle& a, const PreparedTriangle& b) {
  return a.object == b.object && a.side.is_with(b.side);
}

Vec normal_of(const PreparedTriangle& t) { return {t.normal[0], t.normal[1], t.normal[2]}; }

// How far `away` leads along a triangle's normal, towards the outside.
double outward(const PreparedTriangle& t, const Vec& away) {
  const double along = dot(normal_of(t), away);
  return t.side.is_reversed() ? -along : along;
}

// The corners of the whole triangle, from the node's lowest corner.
Corners corners_of(const SceneTriangles& scene, const scan::NodeIndex& node,
                   const PreparedTriangle& t) {
  const lattice::LatticeTriangle whole = scene.original(t);
  Corners corners;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t d = 0; d < 3; ++d) {
      corners[k][d] = static_cast<double>(whole[k][d] - node[d] * 64 * lattice::kSnapUnits);
    }
  }
  return corners;
}

// How far `away` leads to the outside along the angle-weighted normal of the triangles of a
// component that meet at `foot`.
double outward_at(const SceneTriangles& scene, const scan::NodeIndex& node, const Vec& foot,
                  const Vec& away, const PreparedTriangle& nearest, TriangleList list) {
  const std::array<float, 3> at = rounded(foot);
  // A place in front of the planes of all is in front of their sum, and so is one behind all.
  double min = 0, max = 0;
  for (const PreparedTriangle* const t : list) {
    if (!may_reach(*t, at, 1) || !are_of_one(*t, nearest)) continue;
    const double along = outward(*t, away);
    min = std::min(min, along), max = std::max(max, along);
  }
  if (min == 0 || max == 0) return min + max;
  Vec normal{};
  std::vector<std::uint32_t> added;  // a large triangle may be there in pieces
  for (const PreparedTriangle* const t : list) {
    if (!may_reach(*t, at, 1) || t->object != nearest.object) continue;
    const TriangleSide side = scene.side_of(t->object, t->source);
    if (!side.is_with(nearest.side)) continue;
    if (std::find(added.begin(), added.end(), t->source) != added.end()) continue;
    added.push_back(t->source);
    const Vec more = weighted_normal(corners_of(scene, node, *t), foot);
    for (std::size_t d = 0; d < 3; ++d) normal[d] += side.is_reversed() ? -more[d] : more[d];
  }
  return dot(normal, away);
}

bool is_behind_component(const SceneTriangles& scene, const scan::NodeIndex& node, const Vec& place,
                         const Vec& away, const PreparedTriangle& nearest, TriangleList list) {
  if (!nearest.side.is_closed()) return false;
  // In front of the inner part of a triangle, the triangle alone decides.
  constexpr double kInFront = 1 - 1e-10;  // the squared cosine
  const double along = outward(nearest, away);
  const Vec normal = normal_of(nearest);  // a unit vector, rounded
  if (along * along >= kInFront * dot(normal, normal) * dot(away, away)) return along < 0;
  return outward_at(scene, node, minus(place, away), away, nearest, list) < 0;
}

}  // namespace

bool is_behind(const SceneTriangles& scene, const scan::NodeIndex& node, const Vec& place,
               const Vec& away, const PreparedTriangle& nearest, const NearTriangles& near) {
  if (is_behind_component(scene, node, place, away, nearest, near.list)) return true;
  if (!near.are_mixed) return false;
  constexpr double kAsNear = double{kKernelErrorVoxels} * double{lattice::kSnapUnits};
  const std::array<float, 3> at = rounded(place);
  const double reach = length(away) + kAsNear;
  return std::any_of(near.list.begin(), near.list.end(), [&](const PreparedTriangle* t) {
    if (!t->side.is_closed() || are_of_one(*t, nearest)) return false;
    if (!may_reach(*t, at, static_cast<float>(reach))) return false;
    const Vec other = offset_from(*t, place);
    return length(other) <= reach && is_behind_component(scene, node, place, other, *t, near.list);
  });
}

}  // namespace forcelayer::distance

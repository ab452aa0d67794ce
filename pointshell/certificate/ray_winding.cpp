#include "pointshell/certificate/ray_winding.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forcelayer::certificate {
namespace {

using part::Vec3;

// A unit vector that no face or edge of a drawing runs along, and the same for what is computed
// along it: the sums of a dozen products.
constexpr Vec3 kRay{0.5437211, 0.2913847, 0.7870619};
constexpr double kRayRounding = 1e-13;
constexpr double kRoundUp = 1 + 1e-9;  // exceeds that of a slab of a box

// Whether a ray from a place may meet a node's box, which is larger by `wider` on each side, and is
// seen as larger by `off`.
bool may_cross(const part::TriangleTree::Node& node, const Vec3& place, double off,
               double wider = 0) {
  double enters = -off, leaves = std::numeric_limits<double>::infinity();
  const auto across = [&](double low, double high, double from, double along) {
    const double a = (low - wider - from) / along, b = (high + wider - from) / along;
    enters = std::max(enters, std::min(a, b));
    leaves = std::min(leaves, std::max(a, b));
  };
  across(node.low[0], node.high[0], place.x, kRay.x);
  across(node.low[1], node.high[1], place.y, kRay.y);
  across(node.low[2], node.high[2], place.z, kRay.z);
  return enters <= leaves + off;
}

// 1 where a ray from a place leaves through a triangle, -1 where it enters, 0 where it passes. None
// where rounding decides; no corner is farther from the place than `reach`.
std::optional<int> crossing_of(const part::Piece& triangle, const Vec3& place, double reach) {
  const Vec3 a = triangle[0] - place, b = triangle[1] - place, c = triangle[2] - place;
  const double of_edges[] = {part::dot(kRay, part::cross(a, b)), part::dot(kRay, part::cross(b, c)),
                             part::dot(kRay, part::cross(c, a))};
  const double low = std::min({of_edges[0], of_edges[1], of_edges[2]});
  const double high = std::max({of_edges[0], of_edges[1], of_edges[2]});
  const double off = kRayRounding * reach * reach;
  if (low < -off && high > off) return 0;  // the line passes beside it
  if (!(low > off || high < -off)) return std::nullopt;
  // The line goes through: ahead of the place or behind it?
  const double volume = part::dot(a, part::cross(b, c));
  if (!(std::abs(volume) > off * reach)) return std::nullopt;
  const int side = low > 0 ? 1 : -1;
  return (volume > 0) == (side > 0) ? side : 0;
}

}  // namespace

std::optional<int> windings_by_ray(const part::TriangleTree& tree, const Vec3& place) {
  const part::TriangleTree::Node& whole = tree.nodes()[0];
  double reach = 0;  // no corner is farther away
  for (std::size_t n = 0; n < 3; ++n) {
    const double at = n == 0 ? place.x : n == 1 ? place.y : place.z;
    reach += std::max(std::abs(whole.low[n] - at), std::abs(whole.high[n] - at));
  }
  const double off = kRayRounding * reach;
  std::optional<int> windings = 0;
  tree.visit_where(
      [&](const part::TriangleTree::Node& node) { return windings && may_cross(node, place, off); },
      [&](std::uint32_t triangle) {
        const auto crossing =
            crossing_of(part::triangle_piece(tree.part(), triangle), place, reach);
        windings = windings && crossing ? std::optional(*windings + *crossing) : std::nullopt;
      });
  return windings;
}

// The distance of a ray and an edge is convex along the ray, and least where that is nearest to the
// edge's line, or to one of its ends, or where it begins.
bool is_ray_within(const part::TriangleTree& edges, const Vec3& place, double radius) {
  bool is_near = false;
  edges.visit_where(
      [&](const part::TriangleTree::Node& node) {
        return !is_near && may_cross(node, place, 0, kRoundUp * radius);
      },
      [&](std::uint32_t number) {
        const part::Piece edge = part::triangle_piece(edges.part(), number);
        const Vec3 along = edge[1] - edge[0], from = edge[0] - place;
        const auto look_at = [&](double way) {
          const Vec3 there = std::max(way, 0.0) * kRay;
          const Vec3 foot = part::nearest_on_triangle(place + there, edge[0], edge[1], edge[2]);
          is_near = is_near || part::length(foot - place - there) <= radius;
        };
        const double k = part::length_squared(kRay), b = part::dot(kRay, along),
                     c = part::length_squared(along);
        const double to_first = part::dot(kRay, from), of_line = part::dot(along, from);
        look_at(to_first / k);
        look_at((to_first + b) / k);
        look_at(0);
        const double square = k * c - b * b;
        if (square > 0) look_at((c * to_first - b * of_line) / square);
      });
  return is_near;
}

}  // namespace forcelayer::certificate

#include "workbench/exact/push_out.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace forcelayer::exact {
namespace {

using part::Piece;
using part::Vec3;

// So many triangles are looked at for directions.
constexpr std::size_t kMaxNear = 128;
// Directions that differ by less are one, and so many are tried.
constexpr double kSameNormal = 1 - 1e-6;
constexpr std::size_t kMaxNormals = 8;
// Rounding of a length along a direction, as a fraction of the largest coordinate: far above it.
constexpr double kRounding = 1e-14;
// Shifts are this much shorter than allowed, for their own rounding.
constexpr double kShorter = 1 - 1e-6;

struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void take(double at) {
    low = std::min(low, at);
    high = std::max(high, at);
  }
};

double largest_of(const Hull& hull) {
  double largest = 0;
  for (std::size_t n = 0; n < hull.count; ++n) {
    largest = std::max(largest, part::max_abs(hull.points[n]));
  }
  return largest;
}

// A triangle near the hull, and how far the two are apart along some directions.
class Neighbor {
 public:
  Neighbor(const Hull& hull, const Piece& triangle) {
    const std::array<Vec3, 3> sides{triangle[1] - triangle[0], triangle[2] - triangle[1],
                                    triangle[0] - triangle[2]};
    normal_ = part::normalized(part::cross(sides[0], triangle[2] - triangle[0]));
    add(hull, triangle, normal_);
    for (const Vec3& side : sides) {
      add(hull, triangle, part::cross(normal_, side));
      for (std::size_t n = 0; n < hull.edge_count; ++n) {
        add(hull, triangle, part::cross(side, hull.edges[n]));
      }
    }
    for (std::size_t n = 0; n < hull.edge_count; ++n) {
      for (std::size_t m = n + 1; m < hull.edge_count; ++m) {
        add(hull, triangle, part::cross(hull.edges[n], hull.edges[m]));
      }
    }
  }

  // Whether the hull, shifted, is farther away than this along one of the directions.
  bool is_farther(double min_m, const Vec3& shift = {}) const {
    return std::any_of(gaps_.begin(), gaps_.begin() + count_, [&](const Gap& gap) {
      const double moved = part::dot(gap.direction, shift);
      return std::max(gap.ahead - moved, gap.behind + moved) > min_m;
    });
  }

  const Vec3& normal() const { return normal_; }

 private:
  struct Gap {
    Vec3 direction;
    double ahead, behind;  // how far the triangle lies ahead of the hull, and behind it
  };

  void add(const Hull& hull, const Piece& triangle, const Vec3& along) {
    const Vec3 direction = part::normalized(along);
    if (direction == Vec3{}) return;
    Interval of_hull, of_triangle;
    for (std::size_t n = 0; n < hull.count; ++n) of_hull.take(part::dot(hull.points[n], direction));
    for (const Vec3& p : triangle) of_triangle.take(part::dot(p, direction));
    gaps_[count_++] = {direction, of_triangle.low - of_hull.high, of_hull.low - of_triangle.high};
  }

  Vec3 normal_;
  std::array<Gap, 1 + 3 * 5 + 6> gaps_;
  std::ptrdiff_t count_ = 0;
};

// Calls visit(Neighbor) for each triangle that may be no farther than this from a shifted hull, as
// long as it returns true. Whether it always did.
template <typename Visit>
bool visit_near(const Body& solid, const Hull& hull, const Vec3& shift, double reach_m,
                const Visit& visit) {
  part::Box box;
  for (std::size_t n = 0; n < hull.count; ++n) box.grow(hull.points[n] + shift);
  const part::TriangleTree& tree = solid.tree();
  bool goes_on = true;
  tree.visit_where(
      [&](const part::TriangleTree::Node& node) {
        return goes_on && node.low[0] <= box.high.x + reach_m &&
               node.high[0] >= box.low.x - reach_m && node.low[1] <= box.high.y + reach_m &&
               node.high[1] >= box.low.y - reach_m && node.low[2] <= box.high.z + reach_m &&
               node.high[2] >= box.low.z - reach_m;
      },
      [&](std::uint32_t triangle) {
        if (!goes_on) return;
        const Neighbor neighbor(hull, part::triangle_piece(tree.part(), triangle));
        if (!neighbor.is_farther(reach_m, shift)) goes_on = visit(neighbor);
      });
  return goes_on;
}

// Directions in which a hull may come free: to the nearest place of the surface, or away from it;
// out of faces nearby, and of all of them together.
std::vector<Vec3> ways_out(const Body& solid, const Hull& hull, double reach_m) {
  std::vector<Vec3> ways;
  const auto nearest = solid.tree().nearest(hull.center);
  const double side = solid.holds(hull.center) ? 1 : -1;
  const auto add = [&](const Vec3& way) {
    const bool is_known = std::any_of(ways.begin(), ways.end(), [&](const Vec3& other) {
      return part::dot(way, other) > kSameNormal;
    });
    if (!(way == Vec3{}) && !is_known) ways.push_back(way);
  };
  add(part::normalized(side * (nearest.point.position - hull.center)));
  Vec3 sum;
  std::size_t seen = 0;
  visit_near(solid, hull, {}, reach_m, [&](const Neighbor& neighbor) {
    const std::size_t before = ways.size();
    add(solid.outward() * neighbor.normal());
    if (ways.size() > before) sum += ways.back();
    return ++seen < kMaxNear && ways.size() <= kMaxNormals;
  });
  add(part::normalized(sum));
  return ways;
}

}  // namespace

Hull::Hull(const Piece& piece)
    : count(3),
      edges{piece[1] - piece[0], piece[2] - piece[1], piece[0] - piece[2]},
      edge_count(3) {
  std::copy(piece.begin(), piece.end(), points.begin());
  center = part::centroid(piece);
  for (const Vec3& p : piece) reach = std::max(reach, part::length(p - center));
}

Hull::Hull(const Piece& from, const Piece& to) : Hull(from) {
  count = 6;
  std::copy(to.begin(), to.end(), points.begin() + 3);
  edges[edge_count++] = part::centroid(to) - center;
  center = 0.5 * (center + part::centroid(to));
  reach = 0;
  for (const Vec3& p : points) reach = std::max(reach, part::length(p - center));
}

bool comes_free(const Body& solid, const Hull& hull, double max_m, double off_m) {
  // Through a crack a way leads inside that meets no triangle, but it is narrow.
  off_m += solid.crack_m();
  const double rounding_m = kRounding * largest_of(hull);
  const auto is_free = [&](const Vec3& shift) {
    return visit_near(solid, hull, shift, off_m + rounding_m,
                      [](const Neighbor&) { return false; }) &&
           !solid.holds(hull.center + shift);
  };
  if (is_free({})) return true;
  const std::vector<Vec3> ways = ways_out(solid, hull, max_m + off_m + rounding_m);
  return std::any_of(ways.begin(), ways.end(),
                     [&](const Vec3& way) { return is_free((kShorter * max_m) * way); });
}

}  // namespace forcelayer::exact

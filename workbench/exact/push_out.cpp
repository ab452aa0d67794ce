#include "workbench/exact/push_out.h"

#include <algorithm>
#include <cmath>
#include <utility>
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
// Normals of one side leave its direction by no more than this, as a cosine: sharper edges are thin
// walls. It is looked for in steps of this factor at least, for so many normals.
constexpr double kMinAlong = 0.4, kLess = 0.9;
constexpr std::size_t kMaxOfSide = 512;
// Widths of a crack: half of what a pocket that opens through it alone, between faces of one side,
// is deep at most.
constexpr double kHiddenByCrack = 1 / kMinAlong;
// Rounding of a length along a direction, as a fraction of the largest coordinate: far above it.
constexpr double kRounding = 1e-14;
// Shifts are this much shorter than allowed, for their own rounding.
constexpr double kShorter = 1 - 1e-6;

double rounding_of_m(const Hull& hull) {
  double largest = 0;
  for (std::size_t n = 0; n < hull.count; ++n) {
    largest = std::max(largest, part::max_abs(hull.points[n]));
  }
  return kRounding * largest;
}

Vec3 normal_of(const Piece& triangle) {
  return part::normalized(part::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]));
}

// Calls visit(triangle) for each triangle that may be no farther than this from a shifted hull and
// what bends out of it, as long as it returns true. Whether it always did.
template <typename Visit>
bool visit_near(const Body& solid, const Hull& hull, const Vec3& shift, double min_m,
                const Bend& bend, const Visit& visit) {
  const double reach_m = min_m + bend.max_m;
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
        const Piece piece = part::triangle_piece(tree.part(), triangle);
        if (!is_farther(hull, piece, shift, min_m, bend)) goes_on = visit(piece);
      });
  return goes_on;
}

// Directions in which a hull may come free: to the nearest place of the surface, or away from it;
// out of faces nearby, of all of them together, and of two of them.
std::vector<Vec3> directions_out(const Body& solid, const Hull& hull, double reach_m,
                                 const Bend& bend) {
  const auto add = [](std::vector<Vec3>& directions, const Vec3& direction) {
    const bool is_known = std::any_of(directions.begin(), directions.end(), [&](const Vec3& other) {
      return part::dot(direction, other) > kSameNormal;
    });
    if (!(direction == Vec3{}) && !is_known) directions.push_back(direction);
  };
  // The normals of the faces nearby. They are kept apart from the direction to the nearest place,
  // which may be one of them: the edge of that face needs its normal, too.
  std::vector<Vec3> normals;
  std::size_t seen = 0;
  visit_near(solid, hull, {}, reach_m, bend, [&](const Piece& triangle) {
    add(normals, solid.outward() * normal_of(triangle));
    return ++seen < kMaxNear && normals.size() < kMaxNormals;
  });
  std::vector<Vec3> directions;
  const auto nearest = solid.tree().nearest(hull.center);
  const double side = solid.holds(hull.center) ? 1 : -1;
  add(directions, part::normalized(side * (nearest.point.position - hull.center)));
  Vec3 sum;
  for (const Vec3& normal : normals) add(directions, normal), sum += normal;
  add(directions, part::normalized(sum));
  // Out of an edge between two faces, although the end of that edge is near.
  for (std::size_t i = 0; i < normals.size(); ++i) {
    for (std::size_t k = i + 1; k < normals.size(); ++k) {
      add(directions, part::normalized(normals[i] + normals[k]));
    }
  }
  return directions;
}

// Whether all places of a motion are on one side of the surface, once they are shifted.
bool is_apart(const Body& solid, const Hull& hull, const Vec3& shift, const Bend& bend) {
  // Through a crack a direction leads inside that meets no triangle, but it is narrow.
  const double crack_m = solid.crack_near_m(hull.center + shift, hull.reach + bend.max_m);
  return visit_near(solid, hull, shift, crack_m + rounding_of_m(hull), bend,
                    [](const Piece&) { return false; });
}

// Whether all of them are outside then, or inside.
bool is_free(const Body& solid, const Hull& hull, const Vec3& shift, const Bend& bend) {
  return is_apart(solid, hull, shift, bend) && !solid.holds(hull.center + shift);
}
bool is_held(const Body& solid, const Hull& hull, const Vec3& shift, const Bend& bend) {
  return is_apart(solid, hull, shift, bend) && solid.holds(hull.center + shift);
}

// The direction that is found nearest to some unit vectors, and the smallest cosine between it and
// them: their mean, turned to the farthest one by less and less.
std::pair<Vec3, double> along_all(const std::vector<Vec3>& normals) {
  constexpr int kTurns = 24;
  Vec3 sum, farthest;
  for (const Vec3& normal : normals) sum += normal;
  std::pair<Vec3, double> best{{}, -1};
  Vec3 direction = part::normalized(sum);
  for (int turn = 0; turn < kTurns; ++turn) {
    double along = 1;
    for (const Vec3& normal : normals) {
      const double cosine = part::dot(normal, direction);
      if (cosine < along) along = cosine, farthest = normal;
    }
    if (along > best.second) best = {direction, along};
    direction = part::normalized(direction + (1.0 / (turn + 2)) * farthest);
  }
  return best;
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

bool is_farther_along(const Vec3& along, const Hull& hull, const Piece& triangle, const Vec3& shift,
                      double min_m, const Bend& bend) {
  const double length = part::length(along);
  if (length == 0) return false;
  if (bend.max_m > 0) min_m += bend.along_m((1 / length) * along);
  const double moved = part::dot(along, shift);
  double low = part::dot(along, hull.points[0]), high = low;
  for (std::size_t n = 1; n < hull.count; ++n) {
    const double at = part::dot(along, hull.points[n]);
    low = std::min(low, at), high = std::max(high, at);
  }
  const double a = part::dot(along, triangle[0]), b = part::dot(along, triangle[1]),
               c = part::dot(along, triangle[2]);
  return std::max(std::min({a, b, c}) - high - moved, low - std::max({a, b, c}) + moved) >
         min_m * length;
}

bool is_farther(const Hull& hull, const Piece& triangle, const Vec3& shift, double min_m,
                const Bend& bend) {
  const auto parts = [&](const Vec3& along) {
    return is_farther_along(along, hull, triangle, shift, min_m, bend);
  };
  const Vec3 normal =
      part::normalized(part::cross(triangle[1] - triangle[0], triangle[2] - triangle[0]));
  if (parts(normal)) return true;
  for (std::size_t n = 0; n < hull.edge_count; ++n) {
    for (std::size_t m = n + 1; m < hull.edge_count; ++m) {
      if (parts(part::cross(hull.edges[n], hull.edges[m]))) return true;
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 side = triangle[(i + 1) % 3] - triangle[i];
    if (parts(part::cross(normal, side))) return true;
    for (std::size_t n = 0; n < hull.edge_count; ++n) {
      if (parts(part::cross(side, hull.edges[n]))) return true;
    }
  }
  return false;
}

bool stays_outside(const Body& solid, const Hull& hull, const Bend& bend) {
  return is_free(solid, hull, {}, bend);
}

bool comes_free(const Body& solid, const Hull& hull, double max_m, const Bend& bend) {
  if (stays_outside(solid, hull, bend)) return true;
  const std::vector<Vec3> directions =
      directions_out(solid, hull, max_m + solid.crack_m() + rounding_of_m(hull), bend);
  return std::any_of(directions.begin(), directions.end(), [&](const Vec3& direction) {
    return is_free(solid, hull, (kShorter * max_m) * direction, bend);
  });
}

Sides sides_of(const Body& solid, const Hull& hull, double depth_m, const Bend& bend) {
  // No direction is so near to two normals that are farther from each other.
  constexpr double kMinBetween = 2 * kMinAlong * kMinAlong - 1;
  const auto normal_out = [&](const Piece& triangle) {
    return solid.outward() * normal_of(triangle);
  };
  const double rounding_m = rounding_of_m(hull), hidden_m = kHiddenByCrack * solid.crack_m();
  double along = 1;
  std::vector<Vec3> normals;
  while (along >= kMinAlong) {
    // Cracks may hide as much more depth.
    double deep_m = depth_m + rounding_m;
    const double near_m = hull.reach + bend.max_m + 2 / along * (deep_m + hidden_m);
    const bool is_crack_near = solid.crack_near_m(hull.center, near_m) > 0;
    if (is_crack_near) deep_m += hidden_m;
    normals.clear();
    const double reach_m = (1 + 1 / along) * deep_m;
    const bool may_have = visit_near(solid, hull, {}, reach_m, bend, [&](const Piece& triangle) {
      const Vec3 normal = normal_out(triangle);
      if (normal == Vec3{}) return true;
      for (const Vec3& other : normals) {
        if (normal == other) return true;
        if (part::dot(normal, other) < kMinBetween) return false;
      }
      normals.push_back(normal);
      return normals.size() < kMaxOfSide;
    });
    if (!may_have) return Sides::kBoth;
    if (normals.empty()) return Sides::kOne;
    const auto [nearest, found] = along_all(normals);
    if (found >= along) {
      const Vec3 direction = nearest, out = (2 / along * deep_m) * direction;
      // The ways that lead out beyond what is near lie in this ball.
      const double wide_m = std::hypot(1, 0.5 / along) * deep_m;
      const bool is_one =
          visit_near(solid, hull, 0.75 * out, wide_m, bend,
                     [&](const Piece& triangle) {
                       const Vec3 normal = normal_out(triangle);
                       return normal == Vec3{} || part::dot(normal, direction) >= along;
                     }) &&
          is_free(solid, hull, out, bend) && (!is_crack_near || is_held(solid, hull, -out, bend));
      return is_one ? Sides::kOne : Sides::kUnknown;
    }
    along = std::min(found, kLess * along);
  }
  return Sides::kBoth;
}

}  // namespace forcelayer::exact

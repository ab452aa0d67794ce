#include "workbench/exact/motion_proof.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pointshell/part/pieces.h"
#include "workbench/exact/watch.h"

namespace forcelayer::exact {
namespace {

using part::Piece;
using part::Vec3;

// A motion that takes more cells, and more for each triangle, is cut in two before its pieces are.
constexpr std::uint64_t kMaxCells = 4000, kCellsOfTriangle = 4;
// A side is looked for by the allowed depth and by less, down to this fraction of it. The search
// for a depth ends where it is known so closely, by ratio.
constexpr double kLeastDepth = 0x1p-16, kDepthRatio = 1.1;

Vec3 placed(const Pose& pose, const Vec3& p) {
  return vec3_of(pose.position_m + pose.orientation * dvec3_of(p));
}

Piece placed(const Pose& pose, const Piece& piece) {
  return {placed(pose, piece[0]), placed(pose, piece[1]), placed(pose, piece[2])};
}

bool lies_on(const Body& solid, std::uint32_t number, const Hull& hull, double depth_m,
             const Bend& bend) {
  const Piece triangle = part::triangle_piece(solid.tree().part(), number);
  return std::all_of(hull.points.begin(), hull.points.end(), [&](const Vec3& p) {
    const Vec3 foot = part::nearest_on_triangle(p, triangle[0], triangle[1], triangle[2]);
    return part::length(p - foot) + bend.max_m <= depth_m;
  });
}

bool is_no_deeper(const Body& solid, const Hull& hull, double depth_m, const Bend& bend) {
  return lies_on(solid, solid.tree().nearest(hull.center).point.triangle, hull, depth_m, bend) ||
         comes_free(solid, hull, depth_m, bend);
}

class Proof {
 public:
  Proof(const Body& surface, const Body& solid, const Motion& motion, double allowed_m,
        std::size_t max_open, std::vector<Piece>& met)
      : surface_(surface),
        solid_(solid),
        motion_(motion),
        allowed_m_(allowed_m),
        max_cells_(kMaxCells + kCellsOfTriangle * surface.tree().ordered_triangles().size()),
        max_open_(max_open),
        met_(met) {}

  Parts left_of(const Parts& parts) {
    for (const Piece& piece : parts.pieces) settle(piece);
    std::vector<std::uint32_t> open = parts.nodes;
    while (!open.empty() && goes_on()) {
      const part::TriangleTree& tree = surface_.tree();
      const std::uint32_t number = open.back();
      open.pop_back();
      const part::TriangleTree::Node& node = tree.nodes()[number];
      if (is_far(node)) continue;
      for (std::uint32_t n = 0; n < node.count; ++n) {
        settle(part::triangle_piece(tree.part(), tree.ordered_triangles()[node.first + n]));
      }
      if (node.count > 0) continue;
      open.push_back(node.first);
      open.push_back(number + 1);
    }
    left_.nodes = std::move(open);
    return std::move(left_);
  }

  std::uint64_t cells() const { return cells_; }

 private:
  // Whether all of a node stays outside, and away from the surface.
  bool is_far(const part::TriangleTree::Node& node) {
    keep_going();
    ++cells_;
    const Vec3 low{node.low[0], node.low[1], node.low[2]},
        high{node.high[0], node.high[1], node.high[2]};
    const Vec3 center = placed(motion_.middle, 0.5 * (low + high));
    const double reach_m = part::length(high - low) / 2 + motion_.half_travel_m;
    return !solid_.tree().is_within(center, reach_m + solid_.crack_near_m(center, reach_m)) &&
           !solid_.holds(center);
  }

  bool goes_on() const { return cells_ <= max_cells_ && left_.pieces.size() <= max_open_; }

  // Leaves those pieces that it is cut in of which a place may go too deep.
  void settle(const Piece& whole) {
    pieces_.assign(1, whole);
    while (!pieces_.empty() && goes_on()) {
      keep_going();
      ++cells_;
      const Piece piece = pieces_.back();
      pieces_.pop_back();
      const Piece from = placed(motion_.from, piece), to = placed(motion_.to, piece);
      const Hull hull(from, to);
      if (is_outside(hull)) continue;
      if (is_no_deeper(solid_, hull, allowed_m_, motion_.bend)) {
        met_.push_back(piece);
        continue;
      }
      // Where the motion is the longer, it is cut.
      double travel_m = allowed_m_ / 4;
      for (std::size_t n = 0; n < 3; ++n) {
        travel_m = std::max(travel_m, part::length(to[n] - from[n]));
      }
      const part::LongestEdge longest = part::longest_edge(piece);
      if (longest.length_squared <= travel_m * travel_m) {
        left_.pieces.push_back(piece);
        continue;
      }
      for (const Piece& half : part::bisected(piece, longest.from)) pieces_.push_back(half);
    }
    left_.pieces.insert(left_.pieces.end(), pieces_.begin(), pieces_.end());
  }

  // Whether all of it is outside, and away from the surface.
  bool is_outside(const Hull& hull) const {
    const auto nearest = solid_.tree().nearest(hull.center);
    const double reach_m = hull.reach + motion_.bend.max_m;
    return std::sqrt(nearest.distance_squared) >
               reach_m + solid_.crack_near_m(hull.center, reach_m) &&
           !solid_.holds(hull.center);
  }

  const Body& surface_;
  const Body& solid_;
  const Motion& motion_;
  double allowed_m_;
  std::uint64_t max_cells_, cells_ = 0;
  std::size_t max_open_;
  std::vector<Piece> pieces_;  // of settle()
  Parts left_;
  std::vector<Piece>& met_;
};

}  // namespace

Parts not_proven(const Parts& parts, const Body& surface, const Body& solid, const Motion& motion,
                 double allowed_m, std::size_t max_open, std::uint64_t& cells,
                 std::vector<Piece>& met) {
  Proof proof(surface, solid, motion, allowed_m, max_open, met);
  Parts left = proof.left_of(parts);
  cells += proof.cells();
  return left;
}

Hull hull_of(const Motion& motion, const Piece& piece) {
  return {placed(motion.from, piece), placed(motion.to, piece)};
}

bool keeps_side(const Body& solid, const Hull& hull, double depth_m, const Bend& bend) {
  if (sides_of(solid, hull, depth_m, bend) == Sides::kOne) return true;
  if (stays_outside(solid, hull, bend)) return true;
  // Both sides that are near for the least depth are so for any.
  double small_m = kLeastDepth * depth_m, large_m = depth_m;
  if (sides_of(solid, hull, small_m, bend) == Sides::kBoth) return false;
  while (large_m > kDepthRatio * small_m) {
    const double tried_m = std::sqrt(small_m * large_m);
    const Sides sides = sides_of(solid, hull, tried_m, bend);
    if (sides == Sides::kBoth) {
      large_m = tried_m;
    } else if (sides == Sides::kOne && is_no_deeper(solid, hull, tried_m, bend)) {
      return true;
    } else {
      small_m = tried_m;
    }
  }
  return false;
}

}  // namespace forcelayer::exact

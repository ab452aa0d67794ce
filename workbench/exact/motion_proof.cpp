#include "workbench/exact/motion_proof.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pointshell/part/pieces.h"
#include "workbench/exact/push_out.h"

namespace forcelayer::exact {
namespace {

using part::Piece;
using part::Vec3;

// A motion that takes more cells, and more for each triangle, is cut in two before its pieces are.
constexpr std::uint64_t kMaxCells = 4000, kCellsOfTriangle = 4;

Vec3 placed(const Pose& pose, const Vec3& p) {
  return vec3_of(pose.position_m + pose.orientation * dvec3_of(p));
}

Piece placed(const Pose& pose, const Piece& piece) {
  return {placed(pose, piece[0]), placed(pose, piece[1]), placed(pose, piece[2])};
}

class Proof {
 public:
  Proof(const Body& surface, const Body& solid, const Motion& motion, double allowed_m)
      : surface_(surface),
        solid_(solid),
        motion_(motion),
        allowed_m_(allowed_m),
        max_cells_(kMaxCells + kCellsOfTriangle * surface.tree().ordered_triangles().size()) {}

  bool holds() {
    const part::TriangleTree& tree = surface_.tree();
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
      const std::uint32_t number = open.back();
      open.pop_back();
      const part::TriangleTree::Node& node = tree.nodes()[number];
      if (is_far(node)) continue;
      for (std::uint32_t n = 0; n < node.count; ++n) {
        if (!is_settled(
                part::triangle_piece(tree.part(), tree.ordered_triangles()[node.first + n])))
          return false;
      }
      if (node.count > 0) continue;
      open.push_back(node.first);
      open.push_back(number + 1);
    }
    return true;
  }

  std::uint64_t cells() const { return cells_; }

 private:
  // Whether all of a node stays outside, and away from the surface.
  bool is_far(const part::TriangleTree::Node& node) {
    ++cells_;
    const Vec3 low{node.low[0], node.low[1], node.low[2]},
        high{node.high[0], node.high[1], node.high[2]};
    const Vec3 center = placed(motion_.middle, 0.5 * (low + high));
    const double reach_m = part::length(high - low) / 2 + motion_.half_travel_m + solid_.crack_m();
    return !solid_.tree().nearest(center, reach_m).found && !solid_.holds(center);
  }

  // Whether no place of a triangle, or of the pieces that it is cut in, goes too deep.
  bool is_settled(const Piece& triangle) {
    pieces_.assign(1, triangle);
    while (!pieces_.empty()) {
      const Piece piece = pieces_.back();
      pieces_.pop_back();
      if (++cells_ > max_cells_) return false;
      const Piece from = placed(motion_.from, piece), to = placed(motion_.to, piece);
      if (is_allowed(Hull(from, to))) continue;
      // Where the motion is the longer, it is cut.
      double travel_m = allowed_m_ / 4;
      for (std::size_t n = 0; n < 3; ++n) {
        travel_m = std::max(travel_m, part::length(to[n] - from[n]));
      }
      const part::LongestEdge longest = part::longest_edge(piece);
      if (longest.length_squared <= travel_m * travel_m) return false;
      for (const Piece& half : part::bisected(piece, longest.from)) pieces_.push_back(half);
    }
    return true;
  }

  bool is_allowed(const Hull& hull) const {
    const auto nearest = solid_.tree().nearest(hull.center);
    const double distance_m = std::sqrt(nearest.distance_squared);
    const double reach_m = hull.reach + motion_.bend_m;
    if (distance_m > reach_m + solid_.crack_m()) return !solid_.holds(hull.center);
    return lies_on(nearest.point.triangle, hull) ||
           comes_free(solid_, hull, allowed_m_, motion_.bend_m);
  }

  bool lies_on(std::uint32_t number, const Hull& hull) const {
    const Piece triangle = part::triangle_piece(solid_.tree().part(), number);
    return std::all_of(hull.points.begin(), hull.points.end(), [&](const Vec3& p) {
      const Vec3 foot = part::nearest_on_triangle(p, triangle[0], triangle[1], triangle[2]);
      return part::length(p - foot) + motion_.bend_m <= allowed_m_;
    });
  }

  const Body& surface_;
  const Body& solid_;
  const Motion& motion_;
  double allowed_m_;
  std::uint64_t max_cells_, cells_ = 0;
  std::vector<Piece> pieces_;
};

}  // namespace

bool is_never_deeper(const Body& surface, const Body& solid, const Motion& motion, double allowed_m,
                     std::uint64_t& cells) {
  Proof proof(surface, solid, motion, allowed_m);
  const bool holds = proof.holds();
  cells += proof.cells();
  return holds;
}

}  // namespace forcelayer::exact

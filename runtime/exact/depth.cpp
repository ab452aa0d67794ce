#include "runtime/exact/depth.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "pointshell/part/pieces.h"

namespace forcelayer::exact {
namespace {

using part::Piece;
using part::Vec3;

// A node of the surface's tree that is to be searched yet, or a piece of a triangle of it, in the
// solid's frame.
struct Open {
  double at_most_m;
  std::size_t pair;
  bool is_piece;
  std::uint32_t node;
  Piece piece;
  bool operator<(const Open& other) const { return at_most_m < other.at_most_m; }
};

double reach_of_m(const Piece& piece, const Vec3& center) {
  double reach = 0;
  for (const Vec3& corner : piece) reach = std::max(reach, part::length(corner - center));
  return reach;
}

// The largest distance of a corner from a triangle.
double farthest_m(const Piece& piece, const Piece& triangle) {
  double farthest = 0;
  for (const Vec3& p : piece) {
    const Vec3 foot = part::nearest_on_triangle(p, triangle[0], triangle[1], triangle[2]);
    farthest = std::max(farthest, part::length(p - foot));
  }
  return farthest;
}

class Search {
 public:
  Search(std::span<const SurfaceInSolid> pairs, double allowed_m, double within_m)
      : pairs_(pairs), allowed_m_(allowed_m), within_m_(within_m) {
    for (const SurfaceInSolid& pair : pairs) {
      solid_from_surface_.push_back(inverse(pair.world_from_solid) * pair.world_from_surface);
    }
  }

  Depth run() {
    for (std::size_t pair = 0; pair < pairs_.size(); ++pair) open_node(pair, 0, 1e300);
    while (!open_.empty() && !is_settled(open_.top().at_most_m)) {
      const Open top = open_.top();
      open_.pop();
      if (top.is_piece) {
        const int edge = part::longest_edge(top.piece).from;
        for (const Piece& half : part::bisected(top.piece, edge))
          open_piece(top.pair, half, top.at_most_m);
      } else {
        open_below(top);
      }
    }
    found_.at_most_m = std::max(settled_m_, found_.found_m);
    if (!open_.empty()) found_.at_most_m = std::max(found_.at_most_m, open_.top().at_most_m);
    return found_;
  }

 private:
  // Depths far from the one that matters need not be known closely.
  bool is_settled(double at_most_m) const {
    const double off_m = std::max(allowed_m_ - at_most_m, (found_.found_m - allowed_m_) / 2);
    return at_most_m <= found_.found_m + std::max(within_m_, off_m);
  }

  Vec3 placed(std::size_t pair, const Vec3& p) const {
    const Pose& pose = solid_from_surface_[pair];
    return vec3_of(pose.position_m + pose.orientation * dvec3_of(p));
  }

  void open_below(const Open& top) {
    const part::TriangleTree& tree = pairs_[top.pair].surface->tree();
    const part::TriangleTree::Node& node = tree.nodes()[top.node];
    if (node.count == 0) {
      open_node(top.pair, top.node + 1, top.at_most_m);
      open_node(top.pair, node.first, top.at_most_m);
    }
    for (std::uint32_t n = 0; n < node.count; ++n) {
      Piece piece = part::triangle_piece(tree.part(), tree.ordered_triangles()[node.first + n]);
      for (Vec3& corner : piece) corner = placed(top.pair, corner);
      open_piece(top.pair, piece, top.at_most_m);
    }
  }

  void open_node(std::size_t pair, std::uint32_t number, double at_most_m) {
    const part::TriangleTree::Node& node = pairs_[pair].surface->tree().nodes()[number];
    const Vec3 low{node.low[0], node.low[1], node.low[2]},
        high{node.high[0], node.high[1], node.high[2]};
    const Vec3 center = placed(pair, 0.5 * (low + high));
    const double reach_m = part::length(high - low) / 2;
    const auto nearest = pairs_[pair].solid->tree().nearest(center);
    const double distance_m = std::sqrt(nearest.distance_squared);
    at_most_m = std::min(at_most_m, distance_m + reach_m);
    if (!settles(at_most_m)) {
      if (!pairs_[pair].solid->holds(center)) {
        at_most_m = std::min(at_most_m, outside_m(pair, distance_m, reach_m));
      }
      open_.push({at_most_m, pair, false, number, {}});
    }
  }

  void open_piece(std::size_t pair, const Piece& piece, double at_most_m) {
    const Body& solid = *pairs_[pair].solid;
    const Vec3 center = part::centroid(piece);
    const double reach_m = reach_of_m(piece, center);
    const auto nearest = solid.tree().nearest(center);
    const double distance_m = std::sqrt(nearest.distance_squared);
    const Piece triangle = part::triangle_piece(solid.tree().part(), nearest.point.triangle);
    at_most_m = std::min({at_most_m, distance_m + reach_m, farthest_m(piece, triangle)});
    if (settles(at_most_m)) return;  // be the place inside or not
    // To know whether it is inside takes the most time. Close to the surface it changes little.
    const bool changes_little = distance_m <= found_.found_m + within_m_ / 2 &&
                                2 * distance_m - solid.crack_m() < reach_m / 2;
    if (!changes_little) {
      const bool is_inside = solid.holds(center);
      const double depth_m = is_inside ? distance_m : -distance_m;
      if (depth_m > found_.found_m) found_ = found(pair, depth_m, center, nearest.point.position);
      if (!is_inside) at_most_m = std::min(at_most_m, outside_m(pair, distance_m, reach_m));
    }
    if (reach_m <= within_m_ / 4) {
      settled_m_ = std::max(settled_m_, at_most_m);
    } else {
      open_.push({at_most_m, pair, true, 0, piece});
    }
  }

  // No place within reach of one that is outside is deeper. It may come in through a crack.
  double outside_m(std::size_t pair, double distance_m, double reach_m) const {
    return reach_m - distance_m + pairs_[pair].solid->crack_m();
  }

  Depth found(std::size_t pair, double depth_m, const Vec3& place, const Vec3& foot) const {
    const Pose& solid = pairs_[pair].world_from_solid;
    const auto world = [&](const Vec3& p) {
      return solid.position_m + solid.orientation * dvec3_of(p);
    };
    return {depth_m, 0, world(place), world(foot), pair};
  }

  // Whether no more need be known of a piece.
  bool settles(double at_most_m) {
    if (!is_settled(at_most_m)) return false;
    settled_m_ = std::max(settled_m_, at_most_m);
    return true;
  }

  std::span<const SurfaceInSolid> pairs_;
  double allowed_m_, within_m_;
  std::vector<Pose> solid_from_surface_;
  std::priority_queue<Open> open_;
  double settled_m_ = -std::numeric_limits<double>::infinity();  // of what need not be cut further
  Depth found_;
};

}  // namespace

Depth deepest(std::span<const SurfaceInSolid> pairs, double allowed_m, double within_m) {
  return Search(pairs, allowed_m, within_m).run();
}

}  // namespace forcelayer::exact

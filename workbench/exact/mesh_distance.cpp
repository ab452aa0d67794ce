#include "workbench/exact/mesh_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "pointshell/part/part.h"
#include "pointshell/part/triangle_tree.h"
#include "workbench/exact/body.h"
#include "workbench/exact/push_out.h"
#include "workbench/exact/triangle_distance.h"
#include "workbench/exact/watch.h"

namespace forcelayer::exact {
namespace {

using part::Vec3;
using Node = part::TriangleTree::Node;

// A motion that takes more pairs of nodes and triangles, and more for each triangle, is given up:
// each of its halves takes fewer.
constexpr std::uint64_t kMaxPairs = 1 << 14, kPairsOfTriangle = 64;
// Rounding of a place and of a length along a direction, as a fraction of the largest coordinate:
// far above it.
constexpr double kOfPlaces = 1e-13;

part::Part part_of(const Surface& surface) {
  part::Part part;
  for (const glm::dvec3& v : surface.vertices_m) part.vertices.push_back(vec3_of(v));
  part.triangles = surface.triangles;
  return part;
}

struct Bounds {
  glm::dvec3 low{1e300}, high{-1e300};
  void grow(const glm::dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
  void grow(const Corners& triangle) {
    for (const glm::dvec3& corner : triangle) grow(corner);
  }
  double distance_squared(const Bounds& other) const {
    const glm::dvec3 gap = glm::max(glm::max(other.low - high, low - other.high), glm::dvec3(0));
    return glm::dot(gap, gap);
  }
  double size() const { return glm::length(high - low); }
};

Bounds bounds_of(const Node& node) {
  return {{node.low[0], node.low[1], node.low[2]}, {node.high[0], node.high[1], node.high[2]}};
}

glm::dvec3 normal_of(const Corners& t) {
  const glm::dvec3 normal = glm::cross(t[1] - t[0], t[2] - t[0]);
  const double length = glm::length(normal);
  return length > 0 ? normal / length : glm::dvec3(0);
}

// A triangle in the world.
struct Placed {
  Placed() = default;
  explicit Placed(const Corners& its_corners)
      : corners(its_corners), normal(normal_of(its_corners)) {
    bounds.grow(corners);
  }
  // How far another one is off its plane, where all of it lies on one side; else less than zero.
  double off_plane(const Corners& other) const {
    const double a = glm::dot(normal, other[0] - corners[0]),
                 b = glm::dot(normal, other[1] - corners[0]),
                 c = glm::dot(normal, other[2] - corners[0]);
    return std::max(std::min({a, b, c}), -std::max({a, b, c}));
  }
  Corners corners;
  glm::dvec3 normal;
  Bounds bounds;
};

// A pose as a matrix.
struct Placing {
  explicit Placing(const Pose& pose)
      : turned(glm::mat3_cast(pose.orientation)), position_m(pose.position_m) {
    for (int column = 0; column < 3; ++column) of_extents[column] = glm::abs(turned[column]);
  }
  Corners operator()(const Corners& own) const {
    return {position_m + turned * own[0], position_m + turned * own[1],
            position_m + turned * own[2]};
  }
  Bounds operator()(const Bounds& own) const {
    const glm::dvec3 center = position_m + turned * (0.5 * (own.low + own.high));
    const glm::dvec3 extent = of_extents * (0.5 * (own.high - own.low));
    return {center - extent, center + extent};
  }

  glm::dmat3 turned, of_extents;
  glm::dvec3 position_m;
};

}  // namespace

struct MeshPair::Nearest {
  bool is_found = false;
  TriangleDistance distance;  // first of the scene, second of the part
  std::size_t scene_triangle = 0;
};

struct MeshPair::Mesh {
  explicit Mesh(const Surface& surface) : part(part_of(surface)), tree(part) {
    for (const Vec3& v : part.vertices) largest_m = std::max(largest_m, part::max_abs(v));
    for (const std::uint32_t t : tree.ordered_triangles()) {
      const part::Piece piece = part::triangle_piece(part, t);
      triangles.emplace_back(Corners{dvec3_of(piece[0]), dvec3_of(piece[1]), dvec3_of(piece[2])});
    }
  }
  part::Part part;
  part::TriangleTree tree;
  std::vector<Placed> triangles;  // in the tree's order
  double largest_m = 0;
};

namespace {

// A triangle of the part at one pose.
struct Still : Placed {
  Still() = default;
  Still(const Corners& own, const Placing& at, const Placing&) : Placed(at(own)) {}
};

// The same at both ends of a motion.
struct Moving {
  Moving() : hull(part::Piece{}) {}
  Moving(const Corners& own, const Placing& from, const Placing& to) : Moving(from(own), to(own)) {}
  Moving(const Corners& from, const Corners& to)
      : hull(piece_of(from), piece_of(to)),
        middle{0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1]), 0.5 * (from[2] + to[2])},
        normal(normal_of(middle)) {
    bounds.grow(from);
    bounds.grow(to);
  }
  static part::Piece piece_of(const Corners& c) {
    return {vec3_of(c[0]), vec3_of(c[1]), vec3_of(c[2])};
  }
  Hull hull;
  Corners middle;
  glm::dvec3 normal;
  Bounds bounds;
};

// The boxes and triangles of a part at a pose, or between two, as they are asked for.
template <typename Triangle>
class PlacedTree {
 public:
  PlacedTree(const part::TriangleTree& tree, const std::vector<Placed>& own, const Placing& from,
             const Placing& to)
      : tree_(tree), own_(own), from_(from), to_(to), first_(tree.nodes().size(), kUnknown) {}

  // A leaf's box is that of its triangles.
  Bounds bounds(std::uint32_t number) {
    const Node& node = tree_.nodes()[number];
    Bounds bounds;
    if (node.count > 0) {
      for (const Triangle* t = triangles(number); t != triangles(number) + node.count; ++t) {
        bounds.grow(t->bounds.low), bounds.grow(t->bounds.high);
      }
      return bounds;
    }
    bounds = from_(bounds_of(node));
    const Bounds at_end = to_(bounds_of(node));
    bounds.grow(at_end.low), bounds.grow(at_end.high);
    return bounds;
  }

  // Those of a leaf, until the next leaf is asked for.
  const Triangle* triangles(std::uint32_t number) {
    if (first_[number] == kUnknown) {
      const Node& node = tree_.nodes()[number];
      first_[number] = static_cast<std::uint32_t>(placed_.size());
      for (std::uint32_t n = 0; n < node.count; ++n) {
        placed_.emplace_back(own_[node.first + n].corners, from_, to_);
      }
    }
    return placed_.data() + first_[number];
  }

 private:
  static constexpr std::uint32_t kUnknown = 0xffffffff;
  const part::TriangleTree& tree_;
  const std::vector<Placed>& own_;
  const Placing &from_, &to_;
  std::vector<std::uint32_t> first_;  // [nodes] in placed_
  std::vector<Triangle> placed_;
};

// Calls leaves(leaf of the part, leaf of the scene) for all pairs of leaves whose boxes are no
// farther apart than reach_m() is at that time, near ones first, as long as goes_on().
template <typename Triangle, typename Reach, typename GoesOn, typename Leaves>
void visit_leaves(PlacedTree<Triangle>& part, const part::TriangleTree& part_tree,
                  const part::TriangleTree& scene, const Reach& reach_m, const GoesOn& goes_on,
                  const Leaves& leaves) {
  struct Pair {
    std::uint32_t node, other;
    Bounds bounds;
    double distance_squared;
  };
  const auto pair_of = [&](std::uint32_t node, std::uint32_t other, const Bounds& bounds) {
    return Pair{node, other, bounds, bounds.distance_squared(bounds_of(scene.nodes()[other]))};
  };
  std::vector<Pair> open{pair_of(0, 0, part.bounds(0))};
  while (!open.empty() && goes_on()) {
    keep_going();
    const Pair pair = open.back();
    open.pop_back();
    const double reach = reach_m();
    if (pair.distance_squared > reach * reach) continue;
    const Node &node = part_tree.nodes()[pair.node], &other = scene.nodes()[pair.other];
    if (node.count > 0 && other.count > 0) {
      leaves(pair.node, pair.other);
      continue;
    }
    const bool cuts_part =
        other.count > 0 || (node.count == 0 && pair.bounds.size() > bounds_of(other).size());
    Pair near = cuts_part ? pair_of(pair.node + 1, pair.other, part.bounds(pair.node + 1))
                          : pair_of(pair.node, pair.other + 1, pair.bounds);
    Pair far = cuts_part ? pair_of(node.first, pair.other, part.bounds(node.first))
                         : pair_of(pair.node, other.first, pair.bounds);
    if (far.distance_squared < near.distance_squared) std::swap(near, far);
    open.push_back(far);
    open.push_back(near);
  }
}

}  // namespace

std::shared_ptr<const MeshPair::Mesh> MeshPair::mesh_of(const Surface& surface) {
  if (surface.triangles.empty()) return nullptr;
  return std::make_shared<const Mesh>(surface);
}

MeshPair::MeshPair(const Surface& scene, const Surface& part)
    : MeshPair(mesh_of(scene), mesh_of(part)) {}
MeshPair::MeshPair(std::shared_ptr<const Mesh> scene, std::shared_ptr<const Mesh> part) {
  if (scene == nullptr || part == nullptr) return;
  scene_ = std::move(scene), part_ = std::move(part);
}
MeshPair::~MeshPair() = default;
MeshPair::MeshPair(MeshPair&&) noexcept = default;

MeshDistance MeshPair::at(const Pose& world_from_center, double hint_m) const {
  if (!scene_) return {};
  // The search leaves out what is as far apart as the hint.
  if (const auto found = nearer_than(world_from_center, hint_m)) return *found;
  return nearer_than(world_from_center, std::numeric_limits<double>::infinity())
      .value_or(MeshDistance{});
}

std::optional<MeshDistance> MeshPair::nearer_than(const Pose& world_from_center,
                                                  double beyond_m) const {
  if (!scene_) return std::nullopt;
  const Nearest found = nearest(world_from_center, beyond_m);
  if (!found.is_found) return std::nullopt;
  const TriangleDistance& d = found.distance;
  return MeshDistance{d.distance_m, found.scene_triangle, d.second_m, d.first_m};
}

// The nearest triangles; none where all are as far apart as `beyond_m`.
MeshPair::Nearest MeshPair::nearest(const Pose& world_from_center, double beyond_m) const {
  const Placing placing(world_from_center);
  const double rounding_m =
      kOfPlaces *
      std::max(scene_->largest_m, part_->largest_m + glm::length(world_from_center.position_m));
  Nearest found;
  double nearest_m = beyond_m;
  PlacedTree<Still> part(part_->tree, part_->triangles, placing, placing);
  visit_leaves(
      part, part_->tree, scene_->tree, [&] { return nearest_m + rounding_m; },
      [&] { return nearest_m > 0; },
      [&](std::uint32_t leaf, std::uint32_t other) {
        const Node &node = part_->tree.nodes()[leaf], &of_scene = scene_->tree.nodes()[other];
        const Bounds box = bounds_of(of_scene);
        const Still* own = part.triangles(leaf);
        for (std::uint32_t n = 0; n < node.count; ++n, ++own) {
          double reach = nearest_m + rounding_m;
          if (own->bounds.distance_squared(box) > reach * reach) continue;
          for (std::uint32_t m = 0; m < of_scene.count; ++m) {
            const Placed& there = scene_->triangles[of_scene.first + m];
            if (own->bounds.distance_squared(there.bounds) > reach * reach ||
                there.off_plane(own->corners) > reach || own->off_plane(there.corners) > reach) {
              continue;
            }
            const TriangleDistance distance = triangle_distance(there.corners, own->corners);
            if (!(distance.distance_m < nearest_m)) continue;
            nearest_m = distance.distance_m;
            reach = nearest_m + rounding_m;
            found = {true, distance, scene_->tree.ordered_triangles()[of_scene.first + m]};
          }
        }
      });
  return found;
}

bool MeshPair::stays_apart(const Pose& from, const Pose& to, double bend_m, double min_m) const {
  if (!scene_) return true;
  const Placing at_begin(from), at_end(to);
  const double largest_m =
      std::max({scene_->largest_m, part_->largest_m + glm::length(from.position_m),
                part_->largest_m + glm::length(to.position_m)});
  const double needed_m = min_m + bend_m + kOfPlaces * largest_m;
  std::uint64_t pairs = 0;
  const std::uint64_t max_pairs =
      kMaxPairs + kPairsOfTriangle * (part_->triangles.size() + scene_->triangles.size());
  bool is_apart = true;
  PlacedTree<Moving> part(part_->tree, part_->triangles, at_begin, at_end);
  const auto is_parted = [&](const Moving& own, const Placed& there) {
    const part::Piece triangle = Moving::piece_of(there.corners);
    const auto parts = [&](const glm::dvec3& along) {
      return is_farther_along(vec3_of(along), own.hull, triangle, {}, needed_m);
    };
    if (parts(there.normal) || parts(own.normal)) return true;
    const TriangleDistance nearest = triangle_distance(own.middle, there.corners);
    if (!(nearest.distance_m > needed_m)) return false;
    return parts(nearest.second_m - nearest.first_m) ||
           is_farther(own.hull, triangle, {}, needed_m);
  };
  visit_leaves(
      part, part_->tree, scene_->tree, [&] { return needed_m; },
      [&] { return is_apart && ++pairs <= max_pairs; },
      [&](std::uint32_t leaf, std::uint32_t other) {
        const Node &node = part_->tree.nodes()[leaf], &of_scene = scene_->tree.nodes()[other];
        const Bounds box = bounds_of(of_scene);
        const Moving* own = part.triangles(leaf);
        for (std::uint32_t n = 0; n < node.count && is_apart; ++n, ++own) {
          if (own->bounds.distance_squared(box) > needed_m * needed_m) continue;
          for (std::uint32_t m = 0; m < of_scene.count && is_apart; ++m) {
            const Placed& there = scene_->triangles[of_scene.first + m];
            if (own->bounds.distance_squared(there.bounds) > needed_m * needed_m) continue;
            ++pairs;
            is_apart = is_parted(*own, there);
          }
        }
      });
  return is_apart && pairs <= max_pairs;
}

}  // namespace forcelayer::exact

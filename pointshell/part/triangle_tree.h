// A bounding-box tree over the triangles of a part: nearest surface point, triangles near a place.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "pointshell/part/part.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::part {

// The point of triangle a, b, c nearest to `place`. The triangle may have no area.
Vec3 nearest_on_triangle(const Vec3& place, const Vec3& a, const Vec3& b, const Vec3& c);

struct SurfacePoint {
  Vec3 position;
  std::uint32_t triangle = 0;  // index into Part::triangles
};

class TriangleTree {
 public:
  // A node with count > 0 is a leaf over ordered_triangles()[first, first + count); else its
  // children are the next node and node `first`. The box is rounded outwards.
  struct Node {
    std::array<float, 3> low, high;
    std::uint32_t first = 0, count = 0;

    double distance_squared(const Vec3& p) const {
      const double x = std::max(std::max(low[0] - p.x, p.x - high[0]), 0.0);
      const double y = std::max(std::max(low[1] - p.y, p.y - high[1]), 0.0);
      const double z = std::max(std::max(low[2] - p.z, p.z - high[2]), 0.0);
      return x * x + y * y + z * z;
    }
    // Whether the cube of this half-edge about `p` meets the box.
    bool meets_cube(const Vec3& p, double half_edge) const {
      return std::max(low[0] - p.x, p.x - high[0]) <= half_edge &&
             std::max(low[1] - p.y, p.y - high[1]) <= half_edge &&
             std::max(low[2] - p.z, p.z - high[2]) <= half_edge;
    }
  };

  // A tree over all triangles of `part`, or over the given ones (at least one). `part` must outlive
  // the tree.
  explicit TriangleTree(const Part& part);
  TriangleTree(const Part& part, std::vector<std::uint32_t> triangles);

  // The surface point nearest to `place` within `radius`; `found` is false where there is none.
  // Among equally near triangles the lowest index wins.
  struct Nearest {
    SurfacePoint point;
    double distance_squared = 0;
    bool found = false;
  };
  Nearest nearest(const Vec3& place, double radius = std::numeric_limits<double>::infinity()) const;

  // Whether nearest(place, radius) finds a point, in less time.
  bool is_within(const Vec3& place, double radius) const;

  // The point nearest to `place` on one of `triangles` (at least one).
  SurfacePoint nearest(const Vec3& place, std::span<const std::uint32_t> triangles) const;

  // Whether the ray from `origin` along `direction` meets a triangle other than `excluded`, farther
  // than `min_distance` directions from its origin.
  bool ray_hits(const Vec3& origin, const Vec3& direction, std::uint32_t excluded,
                double min_distance) const;

  // Calls visit(triangle) for every triangle whose box is within `radius` of `place`, and some
  // more.
  template <typename Visit>
  void visit_near(const Vec3& place, double radius, const Visit& visit) const {
    visit_where([&](const Node& node) { return node.distance_squared(place) <= radius * radius; },
                visit);
  }

  // The same for the cube of this half-edge about `middle`.
  template <typename Visit>
  void visit_near_box(const Vec3& middle, double half_edge, const Visit& visit) const {
    visit_where([&](const Node& node) { return node.meets_cube(middle, half_edge); }, visit);
  }

  // The same for the triangles of all leaves that test(node) lets through, with all nodes above.
  template <typename Test, typename Visit>
  void visit_where(const Test& test, const Visit& visit) const {
    std::array<std::uint32_t, kMaxDepth> stack;
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const std::uint32_t at = stack[--depth];
      const Node& node = nodes_[at];
      if (!test(node)) continue;
      for (std::uint32_t n = 0; n < node.count; ++n) visit(ordered_[node.first + n]);
      if (node.count == 0) {
        stack[depth++] = node.first;
        stack[depth++] = at + 1;
      }
    }
  }

  const Part& part() const { return *part_; }
  std::span<const Node> nodes() const { return nodes_; }
  std::span<const std::uint32_t> ordered_triangles() const { return ordered_; }

 private:
  static constexpr std::size_t kMaxDepth = 96;  // of a tree over 2^32 triangles, halved each time

  struct Placed {
    Vec3 centroid;
    std::uint32_t triangle;
  };
  // Appends the node over these, whose places in ordered_triangles() begin at `first`, to a list of
  // nodes.
  void build(std::span<Placed> placed, std::uint32_t first, std::vector<Node>& nodes);

  const Part* part_;
  std::vector<std::uint32_t> ordered_;
  std::vector<Node> nodes_;
};

}  // namespace forcelayer::part

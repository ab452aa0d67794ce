#include "pointshell/triangle_tree.h"

#include <algorithm>
#include <numeric>

namespace forcelayer {
namespace {

constexpr std::size_t kLeafTriangles = 4;

Vec3 nearest_on_segment(const Vec3& place, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double squared = length_squared(along);
  if (squared == 0) return a;
  return a + std::clamp(dot(place - a, along) / squared, 0.0, 1.0) * along;
}

Vec3 nearer(const Vec3& place, const Vec3& p, const Vec3& q) {
  return length_squared(q - place) < length_squared(p - place) ? q : p;
}

double coordinate(const Vec3& p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

int longest_axis(const Box& box) {
  const Vec3 size = box.high - box.low;
  if (size.x >= size.y && size.x >= size.z) return 0;
  return size.y >= size.z ? 1 : 2;
}

// Whether the ray meets the box beyond its origin; `inverse` is 1 / direction, by component.
bool ray_meets_box(const Vec3& origin, const Vec3& inverse, const Box& box) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  const auto clip = [&](double from, double factor, double low, double high) {
    const double a = (low - from) * factor, b = (high - from) * factor;
    // 0 * infinity, on a face that the ray runs along, is NaN: fmin and fmax pass over it.
    enter = std::fmax(enter, std::fmin(a, b));
    leave = std::fmin(leave, std::fmax(a, b));
  };
  clip(origin.x, inverse.x, box.low.x, box.high.x);
  clip(origin.y, inverse.y, box.low.y, box.high.y);
  clip(origin.z, inverse.z, box.low.z, box.high.z);
  return enter <= leave;
}

// Moeller and Trumbore 1997; false for a triangle seen edge-on.
bool ray_meets_triangle(const Vec3& origin, const Vec3& direction, double least_distance,
                        const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, across = cross(direction, v), from_a = origin - a;
  const double volume = dot(u, across);
  if (volume == 0) return false;
  const double s = dot(from_a, across) / volume;
  const Vec3 lever = cross(from_a, u);
  const double t = dot(direction, lever) / volume;
  return s >= 0 && t >= 0 && s + t <= 1 && dot(v, lever) / volume > least_distance;
}

}  // namespace

void Box::grow(const Vec3& p) {
  low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
  high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
}

Vec3 nearest_on_triangle(const Vec3& place, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 normal = cross(b - a, c - a);
  const double squared = length_squared(normal);
  // Inside all three edge planes (they contain the normal), the foot on the plane is the answer.
  // Where the normal vanishes so do the three products, and the edges decide.
  if (squared > 0 && dot(cross(b - a, place - a), normal) >= 0 &&
      dot(cross(c - b, place - b), normal) >= 0 && dot(cross(a - c, place - c), normal) >= 0) {
    return place - (dot(place - a, normal) / squared) * normal;
  }
  const Vec3 ab = nearest_on_segment(place, a, b);
  const Vec3 bc = nearest_on_segment(place, b, c);
  return nearer(place, nearer(place, ab, bc), nearest_on_segment(place, c, a));
}

TriangleTree::TriangleTree(const Part& part) : part_(&part), ordered_(part.triangles.size()) {
  std::iota(ordered_.begin(), ordered_.end(), 0u);
  *this = TriangleTree(part, std::move(ordered_));
}

TriangleTree::TriangleTree(const Part& part, std::vector<std::uint32_t> triangles)
    : part_(&part), ordered_(std::move(triangles)) {
  std::vector<Vec3> centroids(part.triangles.size());
  for (const std::uint32_t t : ordered_) {
    const Triangle& corners = part.triangles[t];
    centroids[t] = (1.0 / 3) * (part.vertices[corners[0]] + part.vertices[corners[1]] +
                                part.vertices[corners[2]]);
  }
  nodes_.reserve(2 * (ordered_.size() / (kLeafTriangles / 2) + 1));
  build(ordered_, 0, centroids);
}

Box TriangleTree::box_of(std::span<const std::uint32_t> triangles) const {
  Box box;
  for (const std::uint32_t t : triangles) {
    for (const std::uint32_t corner : part_->triangles[t]) box.grow(part_->vertices[corner]);
  }
  return box;
}

void TriangleTree::build(std::span<std::uint32_t> triangles, std::uint32_t first,
                         const std::vector<Vec3>& centroids) {
  const std::size_t at = nodes_.size();
  nodes_.push_back({box_of(triangles), first, static_cast<std::uint32_t>(triangles.size())});
  if (triangles.size() <= kLeafTriangles) return;
  Box of_centroids;
  for (const std::uint32_t t : triangles) of_centroids.grow(centroids[t]);
  const int axis = longest_axis(of_centroids);
  const std::size_t half = triangles.size() / 2;
  std::nth_element(triangles.begin(), triangles.begin() + static_cast<std::ptrdiff_t>(half),
                   triangles.end(), [&](std::uint32_t a, std::uint32_t b) {
                     const double x = coordinate(centroids[a], axis);
                     const double y = coordinate(centroids[b], axis);
                     return x != y ? x < y : a < b;
                   });
  build(triangles.first(half), first, centroids);
  const auto second_child = static_cast<std::uint32_t>(nodes_.size());
  build(triangles.subspan(half), first + static_cast<std::uint32_t>(half), centroids);
  nodes_[at].first = second_child;
  nodes_[at].count = 0;
}

bool TriangleTree::ray_hits(const Vec3& origin, const Vec3& direction, std::uint32_t excluded,
                            double least_distance) const {
  const Vec3 inverse{1 / direction.x, 1 / direction.y, 1 / direction.z};
  std::array<std::uint32_t, kMaxDepth> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t at = stack[--depth];
    const Node& node = nodes_[at];
    if (!ray_meets_box(origin, inverse, node.box)) continue;
    for (std::uint32_t n = 0; n < node.count; ++n) {
      const std::uint32_t t = ordered_[node.first + n];
      const Triangle& corners = part_->triangles[t];
      if (t != excluded &&
          ray_meets_triangle(origin, direction, least_distance, part_->vertices[corners[0]],
                             part_->vertices[corners[1]], part_->vertices[corners[2]])) {
        return true;
      }
    }
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = at + 1;
    }
  }
  return false;
}

TriangleTree::Nearest TriangleTree::nearest(const Vec3& place, double radius) const {
  Nearest best;
  best.distance_squared = radius * radius;
  struct Entry {
    std::uint32_t node;
    double distance_squared;
  };
  std::array<Entry, kMaxDepth> stack;
  std::size_t depth = 0;
  stack[depth++] = {0, nodes_[0].box.distance_squared(place)};
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.distance_squared > best.distance_squared) continue;
    const Node& node = nodes_[entry.node];
    for (std::uint32_t n = 0; n < node.count; ++n) {
      const std::uint32_t t = ordered_[node.first + n];
      const Triangle& corners = part_->triangles[t];
      const Vec3 foot =
          nearest_on_triangle(place, part_->vertices[corners[0]], part_->vertices[corners[1]],
                              part_->vertices[corners[2]]);
      const double squared = length_squared(foot - place);
      const bool tie = best.found && squared == best.distance_squared;
      if (squared > best.distance_squared || (tie && t > best.point.triangle)) continue;
      best = {{foot, t}, squared, true};
    }
    if (node.count > 0) continue;
    Entry near{entry.node + 1, nodes_[entry.node + 1].box.distance_squared(place)};
    Entry far{node.first, nodes_[node.first].box.distance_squared(place)};
    if (far.distance_squared < near.distance_squared) std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
  return best;
}

}  // namespace forcelayer

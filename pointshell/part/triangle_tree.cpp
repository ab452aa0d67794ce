#include "pointshell/part/triangle_tree.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <numeric>

namespace forcelayer::part {
namespace {

constexpr std::size_t kLeafTriangles = 2;

// Squared sines of a triangle's angle. Below the first, differences of products cancel too much of
// the coordinates in its plane: 1e-16 over it is lost. Below the second its plane is not reliable.
constexpr double kThin = 1e-6, kFlat = 1e-20;

float rounded_down(double x) {
  const float nearest = static_cast<float>(x);
  return nearest <= x ? nearest : std::nextafter(nearest, -std::numeric_limits<float>::infinity());
}

TriangleTree::Node node_around(const Box& box, std::uint32_t first, std::uint32_t count) {
  return {{rounded_down(box.low.x), rounded_down(box.low.y), rounded_down(box.low.z)},
          {-rounded_down(-box.high.x), -rounded_down(-box.high.y), -rounded_down(-box.high.z)},
          first,
          count};
}

Vec3 nearest_on_segment(const Vec3& place, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double squared = length_squared(along);
  if (squared == 0) return a;
  return a + std::clamp(dot(place - a, along) / squared, 0.0, 1.0) * along;
}

Vec3 nearer(const Vec3& place, const Vec3& p, const Vec3& q) {
  return length_squared(q - place) < length_squared(p - place) ? q : p;
}

// The same as nearest_on_triangle() by cross products: 1e-16 over the sine is lost. Few triangles
// are thin: their code does not belong into the one for all.
[[gnu::noinline]] Vec3 nearest_on_thin_triangle(const Vec3& place, const Vec3& a, const Vec3& b,
                                                const Vec3& c) {
  const Vec3 ab = b - a, ac = c - a, ap = place - a, normal = cross(ab, ac);
  const double scale = length_squared(normal);
  const double v = dot(cross(ap, ac), normal), w = dot(cross(ab, ap), normal);
  if (v >= 0 && w >= 0 && v + w <= scale &&
      scale > kFlat * length_squared(ab) * length_squared(ac)) {
    return a + (v / scale) * ab + (w / scale) * ac;
  }
  const Vec3 on_ab = nearest_on_segment(place, a, b), on_bc = nearest_on_segment(place, b, c);
  return nearer(place, nearer(place, on_ab, on_bc), nearest_on_segment(place, c, a));
}

// Where along the ray, in directions, it enters the box; infinite where it misses it. `inverse` is
// 1 / direction, by component.
double ray_enters_box(const Vec3& origin, const Vec3& inverse, const TriangleTree::Node& box) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  const auto clip = [&](double from, double factor, double low, double high) {
    const double a = (low - from) * factor, b = (high - from) * factor;
    const double near = a < b ? a : b, far = a < b ? b : a;
    // 0 * infinity, on a face that the ray runs along, is NaN: these comparisons pass over it.
    if (near > enter) enter = near;
    if (far < leave) leave = far;
  };
  clip(origin.x, inverse.x, box.low[0], box.high[0]);
  clip(origin.y, inverse.y, box.low[1], box.high[1]);
  clip(origin.z, inverse.z, box.low[2], box.high[2]);
  return enter <= leave ? enter : std::numeric_limits<double>::infinity();
}

// Moeller and Trumbore 1997; false for a triangle seen edge-on.
bool ray_meets_triangle(const Vec3& origin, const Vec3& direction, double min_distance,
                        const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 u = b - a, v = c - a, across = cross(direction, v), from_a = origin - a;
  const double volume = dot(u, across);
  if (volume == 0) return false;
  const double s = dot(from_a, across) / volume;
  const Vec3 lever = cross(from_a, u);
  const double t = dot(direction, lever) / volume;
  return s >= 0 && t >= 0 && s + t <= 1 && dot(v, lever) / volume > min_distance;
}

}  // namespace

Vec3 nearest_on_triangle(const Vec3& place, const Vec3& a, const Vec3& b, const Vec3& c) {
  // By the barycentric coordinates of the foot on the plane (Ericson, "Real-time collision
  // detection", 2005, section 5.1.5). A triangle without area has none and goes to its edges.
  const Vec3 ab = b - a, ac = c - a, ap = place - a;
  const double bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac);
  const double pb = dot(ap, ab), pc = dot(ap, ac);
  const double scale = bb * cc - bc * bc;
  const double v = cc * pb - bc * pc, w = bb * pc - bc * pb;
  if (!(scale > kThin * (bb * cc))) return nearest_on_thin_triangle(place, a, b, c);
  if (v >= 0 && w >= 0 && v + w <= scale) return a + (v / scale) * ab + (w / scale) * ac;
  const Vec3 on_ab = nearest_on_segment(place, a, b), on_bc = nearest_on_segment(place, b, c);
  return nearer(place, nearer(place, on_ab, on_bc), nearest_on_segment(place, c, a));
}

TriangleTree::TriangleTree(const Part& part) : part_(&part), ordered_(part.triangles.size()) {
  std::iota(ordered_.begin(), ordered_.end(), 0u);
  *this = TriangleTree(part, std::move(ordered_));
}

TriangleTree::TriangleTree(const Part& part, std::vector<std::uint32_t> triangles)
    : part_(&part), ordered_(std::move(triangles)) {
  std::vector<Placed> placed;  // no more than the tree's own: a part has thousands of small trees
  placed.reserve(ordered_.size());
  for (const std::uint32_t t : ordered_) placed.push_back({centroid(triangle_piece(part, t)), t});
  nodes_.reserve(2 * (ordered_.size() / (kLeafTriangles / 2) + 1));
  build(placed, 0, nodes_);
}

void TriangleTree::build(std::span<Placed> placed, std::uint32_t first, std::vector<Node>& nodes) {
  const std::size_t at = nodes.size();
  const std::span<std::uint32_t> triangles = std::span(ordered_).subspan(first, placed.size());
  for (std::size_t n = 0; n < placed.size(); ++n) triangles[n] = placed[n].triangle;
  nodes.push_back(
      node_around(box_of(*part_, triangles), first, static_cast<std::uint32_t>(placed.size())));
  if (placed.size() <= kLeafTriangles) return;
  Box of_centroids;
  for (const Placed& own : placed) of_centroids.grow(own.centroid);
  const int axis = of_centroids.longest_axis();
  const std::size_t half = placed.size() / 2;
  std::nth_element(placed.begin(), placed.begin() + static_cast<std::ptrdiff_t>(half), placed.end(),
                   [&](const Placed& a, const Placed& b) {
                     const double x = coordinate(a.centroid, axis);
                     const double y = coordinate(b.centroid, axis);
                     return x != y ? x < y : a.triangle < b.triangle;
                   });
  const auto build_second = [&](std::vector<Node>& own) {
    build(placed.subspan(half), first + static_cast<std::uint32_t>(half), own);
  };
  constexpr std::size_t kWorthATask = 1 << 12;
  std::vector<Node> beside;  // the nodes of the second half, where they are built at the same time
  if (placed.size() < kWorthATask) {
    build(placed.first(half), first, nodes);
  } else {
    tbb::parallel_invoke([&] { build(placed.first(half), first, nodes); },
                         [&] { build_second(beside); });
  }
  const auto second_child = static_cast<std::uint32_t>(nodes.size());
  if (beside.empty()) build_second(nodes);
  for (Node& node : beside) {
    if (node.count == 0) node.first += second_child;
    nodes.push_back(node);
  }
  nodes[at].first = second_child;
  nodes[at].count = 0;
}

bool TriangleTree::ray_hits(const Vec3& origin, const Vec3& direction, std::uint32_t excluded,
                            double min_distance) const {
  constexpr double kMissed = std::numeric_limits<double>::infinity();
  const Vec3 inverse{1 / direction.x, 1 / direction.y, 1 / direction.z};
  std::array<std::uint32_t, kMaxDepth> stack;
  std::size_t depth = 0;
  if (ray_enters_box(origin, inverse, nodes_[0]) < kMissed) stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t at = stack[--depth];
    const Node& node = nodes_[at];
    for (std::uint32_t n = 0; n < node.count; ++n) {
      const std::uint32_t t = ordered_[node.first + n];
      if (t == excluded) continue;
      const auto [a, b, c] = triangle_piece(*part_, t);
      if (ray_meets_triangle(origin, direction, min_distance, a, b, c)) return true;
    }
    if (node.count > 0) continue;
    // The nearer child goes first: a hit there ends the search.
    std::array<std::uint32_t, 2> child{node.first, at + 1};
    std::array<double, 2> enters{ray_enters_box(origin, inverse, nodes_[child[0]]),
                                 ray_enters_box(origin, inverse, nodes_[child[1]])};
    if (enters[0] < enters[1]) std::swap(child[0], child[1]), std::swap(enters[0], enters[1]);
    for (int n = 0; n < 2; ++n) {
      if (enters[n] < kMissed) stack[depth++] = child[n];
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
  stack[depth++] = {0, nodes_[0].distance_squared(place)};
  while (depth > 0) {
    const Entry entry = stack[--depth];
    if (entry.distance_squared > best.distance_squared) continue;
    const Node& node = nodes_[entry.node];
    for (std::uint32_t n = 0; n < node.count; ++n) {
      const std::uint32_t t = ordered_[node.first + n];
      const auto [a, b, c] = triangle_piece(*part_, t);
      const Vec3 foot = nearest_on_triangle(place, a, b, c);
      const double squared = length_squared(foot - place);
      const bool tie = best.found && squared == best.distance_squared;
      if (squared > best.distance_squared || (tie && t > best.point.triangle)) continue;
      best = {{foot, t}, squared, true};
    }
    if (node.count > 0) continue;
    Entry near{entry.node + 1, nodes_[entry.node + 1].distance_squared(place)};
    Entry far{node.first, nodes_[node.first].distance_squared(place)};
    if (far.distance_squared < near.distance_squared) std::swap(near, far);
    stack[depth++] = far;
    stack[depth++] = near;
  }
  return best;
}

bool TriangleTree::is_within(const Vec3& place, double radius) const {
  bool found = false;
  visit_where(
      [&](const Node& node) { return !found && node.distance_squared(place) <= radius * radius; },
      [&](std::uint32_t triangle) {
        if (found) return;
        const auto [a, b, c] = triangle_piece(*part_, triangle);
        found = length_squared(nearest_on_triangle(place, a, b, c) - place) <= radius * radius;
      });
  return found;
}

SurfacePoint TriangleTree::nearest(const Vec3& place,
                                   std::span<const std::uint32_t> triangles) const {
  SurfacePoint best;
  double best_squared = std::numeric_limits<double>::infinity();
  for (const std::uint32_t t : triangles) {
    const auto [a, b, c] = triangle_piece(*part_, t);
    const Vec3 foot = nearest_on_triangle(place, a, b, c);
    const double squared = length_squared(foot - place);
    if (squared < best_squared || (squared == best_squared && t < best.triangle)) {
      best = {foot, t};
      best_squared = squared;
    }
  }
  return best;
}

}  // namespace forcelayer::part

#include "workbench/exact/map/vertex_clearance.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <set>

#include "pointshell/part/triangle_tree.h"
#include "workbench/exact/exact_walk.h"
#include "workbench/exact/triangle_distance.h"
#include "workbench/exact/watch.h"

namespace forcelayer::exact {
namespace {

constexpr double kMaxPieces = 64;  // of a segment

}  // namespace

// A surface, and its objects as solids where a place asks for them.
struct VertexClearance::Side {
  explicit Side(const Surface& of) : surface(of) {
    for (const glm::dvec3& v : of.vertices_m) mesh.vertices.push_back(vec3_of(v));
    mesh.triangles = of.triangles;
    if (!mesh.triangles.empty()) tree = std::make_unique<part::TriangleTree>(mesh);
    for (std::size_t n = 0; n < of.triangles.size(); ++n) {
      part::Box& box = boxes[of.object[n]];
      for (const std::uint32_t vertex : of.triangles[n]) box.grow(mesh.vertices[vertex]);
    }
  }

  // As far as it is less than `radius_m`.
  double distance_m(const glm::dvec3& place_m, double radius_m) const {
    if (!tree) return radius_m;
    const auto nearest = tree->nearest(vec3_of(place_m), radius_m);
    return nearest.found ? std::sqrt(nearest.distance_squared) : radius_m;
  }

  // The same of a place that moves straight from `from_m` to `to_m`.
  double distance_m(const glm::dvec3& from_m, const glm::dvec3& to_m, double radius_m) const {
    if (!tree) return radius_m;
    // The box of a segment that is not along an axis is larger than the segment: pieces have
    // smaller boxes.
    const glm::dvec3 extent_m = glm::abs(to_m - from_m);
    const double largest_m = std::max({extent_m.x, extent_m.y, extent_m.z});
    const double across_m =
        std::min(extent_m.x + extent_m.y + extent_m.z - largest_m, kMaxPieces * radius_m);
    const int pieces = radius_m > 0 ? 1 + static_cast<int>(across_m / radius_m) : 1;
    for (int n = 0; n < pieces; ++n) {
      const glm::dvec3 a = glm::mix(from_m, to_m, double(n) / pieces),
                       b = glm::mix(from_m, to_m, double(n + 1) / pieces);
      const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
      const auto is_near = [&](const part::TriangleTree::Node& node) {
        double square_m2 = 0;
        for (int axis = 0; axis < 3; ++axis) {
          const double off_m = std::max({low[axis] - double{node.high[std::size_t(axis)]},
                                         double{node.low[std::size_t(axis)]} - high[axis], 0.0});
          square_m2 += off_m * off_m;
        }
        return square_m2 <= radius_m * radius_m;
      };
      tree->visit_where(is_near, [&](std::uint32_t t) {
        const auto& [u, v, w] = mesh.triangles[t];
        const Corners corners{surface.vertices_m[u], surface.vertices_m[v], surface.vertices_m[w]};
        radius_m = std::min(radius_m, triangle_distance({a, b, b}, corners).distance_m);
      });
    }
    return radius_m;
  }

  bool holds(const glm::dvec3& place_m) const {
    const part::Vec3 place = vec3_of(place_m);
    return std::ranges::any_of(boxes, [&](const auto& entry) {
      const auto& [object, box] = entry;
      if (place.x < box.low.x || place.y < box.low.y || place.z < box.low.z) return false;
      if (place.x > box.high.x || place.y > box.high.y || place.z > box.high.z) return false;
      auto known = bodies.find(object);
      if (known == bodies.end()) {
        const Surface own = only(surface, std::span(&object, 1));
        known = bodies.emplace(object, bodies_of(own, widest_crack_m(own))).first;
      }
      return are_solid(known->second) && std::ranges::any_of(known->second, [&](const auto& body) {
               return body->holds(place);
             });
    });
  }

  Surface surface;
  part::Part mesh;
  std::unique_ptr<part::TriangleTree> tree;        // none without triangles
  std::map<std::uint32_t, part::Box> boxes;        // of the objects
  mutable std::map<std::uint32_t, Bodies> bodies;  // of those that were asked for
};

VertexClearance::Placing::Placing(const Pose& pose)
    : turned(glm::mat3_cast(pose.orientation)), position_m(pose.position_m) {}

VertexClearance::VertexClearance(const clearance::CenterPath& path, const Surface& scene,
                                 const Surface& part)
    : path_(path),
      scene_(std::make_unique<Side>(scene)),
      part_(std::make_unique<Side>(part)),
      begin_(path.world_from_center({0, 0})),
      end_(path.world_from_center({path.poses() - 1, 0})) {
  spans_.push_back(span_of({0, 0}, {path.poses() - 1, 0}));
  middles_.push_back(begin_);
  for (std::size_t n = 0; n < path.poses(); ++n) {
    stops_.emplace_back(path.world_from_center({n, 0}));
    if (stops_.back().turned == begin_.turned) continue;
    stops_.clear();
    break;
  }
}
VertexClearance::~VertexClearance() = default;

VertexClearance::Span VertexClearance::span_of(const clearance::Moment& from,
                                               const clearance::Moment& to) const {
  return {from, to, path_.travel_m(to) - path_.travel_m(from), path_.deviation_m(from, to)};
}

// The number of the first half; the second one follows it.
std::size_t VertexClearance::halves_of(std::size_t span) {
  if (spans_[span].halves == 0) {
    const Span whole = spans_[span];
    const clearance::Moment middle = path_.middle(whole.from, whole.to);
    spans_[span].halves = spans_.size();
    middles_[span] = Placing(path_.world_from_center(middle));
    spans_.push_back(span_of(whole.from, middle));
    spans_.push_back(span_of(middle, whole.to));
    middles_.resize(spans_.size(), begin_);
  }
  return spans_[span].halves;
}

template <typename Placed>
double VertexClearance::least_m(const Side& other, const Placed& placed, double reach_m,
                                double within_m) {
  const double least = stops_.empty() ? least_bounded_m(other, placed, reach_m, within_m)
                                      : least_straight_m(other, placed, reach_m);
  return least > 0 && other.holds(placed(begin_)) ? 0 : least;
}

template <typename Placed>
double VertexClearance::least_straight_m(const Side& other, const Placed& placed,
                                         double reach_m) const {
  keep_going();
  glm::dvec3 from_m = placed(stops_.front());
  double least_m = other.distance_m(placed(stops_.back()), other.distance_m(from_m, reach_m));
  for (std::size_t n = 1; n < stops_.size() && least_m > 0; ++n) {
    const glm::dvec3 to_m = placed(stops_[n]);
    least_m = other.distance_m(from_m, to_m, least_m);
    from_m = to_m;
  }
  return least_m;
}

// Spans are cut until each is proven to bring the place no nearer than the least distance that was
// measured, but for `within_m`. A distance beyond what can matter is not searched for.
template <typename Placed>
double VertexClearance::least_bounded_m(const Side& other, const Placed& placed, double reach_m,
                                        double within_m) {
  double measured_m = reach_m, proven_m = reach_m;
  const auto measure = [&](const Placing& at, double travel_m) {
    keep_going();
    const double distance_m = other.distance_m(placed(at), measured_m + travel_m);
    measured_m = std::min(measured_m, distance_m);
    return distance_m;
  };
  struct Open {
    std::size_t span;
    double from_m, to_m;  // the distances at its ends
  };
  std::vector<Open> open;
  const double all_m = spans_[0].travel_m;
  const double begin_m = measure(begin_, all_m), end_m = measure(end_, all_m);
  open.push_back({0, begin_m, end_m});
  while (!open.empty() && measured_m > within_m) {
    const auto [number, from_m, to_m] = open.back();
    open.pop_back();
    const Span& span = spans_[number];
    const double at_least_m =
        min_between_m(from_m, to_m, span.travel_m, [&] { return span.deviation_m; });
    if (at_least_m >= measured_m - within_m) {
      proven_m = std::min(proven_m, at_least_m);
      continue;
    }
    const double travel_m = span.travel_m;
    const std::size_t halves = halves_of(number);
    const double middle_m = measure(middles_[number], travel_m);
    Open near{halves, from_m, middle_m}, far{halves + 1, middle_m, to_m};
    if (to_m < from_m) std::swap(near, far);
    open.push_back(far);
    open.push_back(near);
  }
  if (measured_m <= within_m) return 0;
  return std::min(measured_m, proven_m);
}

double VertexClearance::of_part_m(const glm::dvec3& place_m, double reach_m, double within_m) {
  return least_m(
      *scene_, [&](const Placing& at) { return at.position_m + at.turned * place_m; }, reach_m,
      within_m);
}

double VertexClearance::of_scene_m(const glm::dvec3& place_m, double reach_m, double within_m) {
  return least_m(
      *part_,
      [&](const Placing& at) { return glm::transpose(at.turned) * (place_m - at.position_m); },
      reach_m, within_m);
}

}  // namespace forcelayer::exact

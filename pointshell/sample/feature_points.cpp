#include "pointshell/sample/feature_points.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <tuple>

#include "pointshell/sample/sparse_set.h"

namespace forcelayer::sample {
namespace {

constexpr double kSharpCos = 0.766;    // 40 degrees between the normals of an edge's triangles
constexpr double kStraightCos = 0.71;  // 45 degrees between the edges of a chain
// In radii.
constexpr double kSpacing = 1.6;   // along a chain; that of the front
constexpr double kSeparation = 1;  // no two feature points are closer
constexpr double kMinNetwork = 4;  // length of edges that hang together

// A triangle's side from its lower to its higher vertex.
struct Side {
  std::uint32_t body, low, high, triangle;
  bool ascending;  // whether the triangle runs along it from low to high

  auto key() const { return std::tie(body, low, high, triangle); }
  bool same_edge(const Side& other) const {
    return body == other.body && low == other.low && high == other.high;
  }
};

struct Edge {
  std::uint32_t low, high, triangle;
};

std::vector<Side> sorted_sides(const part::Part& part) {
  std::vector<Side> sides;
  sides.reserve(3 * part.triangles.size());
  for (std::uint32_t t = 0; t < part.triangles.size(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const auto from = part.triangles[t][corner], to = part.triangles[t][(corner + 1) % 3];
      if (from == to) continue;
      sides.push_back({part.body[t], std::min(from, to), std::max(from, to), t, from < to});
    }
  }
  tbb::parallel_sort(sides.begin(), sides.end(),
                     [](const Side& a, const Side& b) { return a.key() < b.key(); });
  return sides;
}

// Whether the surface ends or turns at an edge, given its triangles [first, last).
bool is_feature(const part::Part& part, const Side* first, const Side* last) {
  const auto normal = [&](const Side& side) {
    return part::normalized(part::doubled_area_normal(part, side.triangle));
  };
  const part::Vec3 a = normal(*first);
  if (last - first == 1) return part::length_squared(a) > 0;
  for (const Side* other = first + 1; other != last; ++other) {
    const part::Vec3 b = normal(*other);
    if (part::length_squared(a) == 0 || part::length_squared(b) == 0) continue;
    const double cosine = part::dot(a, b);
    const bool is_same_direction = first->ascending == other->ascending;
    // More than two triangles say nothing about sides: sheets that lie on each other.
    const double turn = last - first > 2 ? std::abs(cosine) : is_same_direction ? -cosine : cosine;
    if (turn < kSharpCos) return true;
  }
  return false;
}

// Ascending; each once, whatever the number of bodies that share it.
std::vector<Edge> feature_edges(const part::Part& part) {
  const std::vector<Side> sides = sorted_sides(part);
  std::vector<Edge> edges;
  for (std::size_t n = 0; n < sides.size();) {
    std::size_t end = n + 1;
    while (end < sides.size() && sides[end].same_edge(sides[n])) ++end;
    if (is_feature(part, &sides[n], sides.data() + end)) {
      edges.push_back({sides[n].low, sides[n].high, sides[n].triangle});
    }
    n = end;
  }
  const auto key = [](const Edge& e) { return std::tie(e.low, e.high); };
  std::stable_sort(edges.begin(), edges.end(),
                   [&](const Edge& a, const Edge& b) { return key(a) < key(b); });
  const auto equal = [&](const Edge& a, const Edge& b) { return key(a) == key(b); };
  edges.erase(std::unique(edges.begin(), edges.end(), equal), edges.end());
  return edges;
}

// The network of the feature edges, over the vertices that they use.
class Network {
 public:
  Network(const part::Part& part, double radius)
      : part_(part), radius_(radius), chosen_(kSeparation * radius) {
    std::vector<Edge> edges = feature_edges(part);
    keep_long_networks(edges);
    edges_ = std::move(edges);
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      ends_.push_back({edges_[e].low, e});
      ends_.push_back({edges_[e].high, e});
    }
    std::sort(ends_.begin(), ends_.end(), [](const End& a, const End& b) {
      return std::tie(a.vertex, a.edge) < std::tie(b.vertex, b.edge);
    });
  }

  std::vector<part::SurfacePoint> points() {
    for (const End& end : ends_) {
      if (is_corner(end.vertex)) add(part_.vertices[end.vertex], edges_[end.edge].triangle);
    }
    walked_.assign(edges_.size(), 0);
    for (const End& end : ends_) {
      if (is_corner(end.vertex)) walk(end);
    }
    for (const End& end : ends_) {  // loops without a corner
      if (walked_[end.edge]) continue;
      add(part_.vertices[end.vertex], edges_[end.edge].triangle);
      walk(end);
    }
    return std::move(points_);
  }

 private:
  struct End {
    std::uint32_t vertex, edge;
  };

  double length_of(const Edge& e) const {
    return part::length(part_.vertices[e.high] - part_.vertices[e.low]);
  }

  void keep_long_networks(std::vector<Edge>& edges) const {
    std::vector<std::uint32_t> parent(part_.vertices.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](std::uint32_t v) {
      while (parent[v] != v) v = parent[v] = parent[parent[v]];
      return v;
    };
    for (const Edge& e : edges) parent[root(e.high)] = root(e.low);
    std::vector<double> length(part_.vertices.size());
    for (const Edge& e : edges) length[root(e.low)] += length_of(e);
    std::erase_if(edges,
                  [&](const Edge& e) { return length[root(e.low)] < kMinNetwork * radius_; });
  }

  std::span<const End> ends_at(std::uint32_t vertex) const {
    const auto [first, last] =
        std::equal_range(ends_.begin(), ends_.end(), End{vertex, 0},
                         [](const End& a, const End& b) { return a.vertex < b.vertex; });
    return {first, last};
  }

  std::uint32_t other_vertex(const End& end) const {
    const Edge& e = edges_[end.edge];
    return e.low == end.vertex ? e.high : e.low;
  }

  part::Vec3 direction(const End& end) const {
    return part::normalized(part_.vertices[other_vertex(end)] - part_.vertices[end.vertex]);
  }

  bool is_corner(std::uint32_t vertex) const {
    const auto ends = ends_at(vertex);
    return ends.size() != 2 || -part::dot(direction(ends[0]), direction(ends[1])) < kStraightCos;
  }

  void add(const part::Vec3& place, std::uint32_t triangle) {
    if (chosen_.any_within_separation(place)) return;
    chosen_.add(place);
    points_.push_back({place, triangle});
  }

  // Follows the chain that leaves a vertex along an edge, to a corner or back to the vertex, and
  // puts points evenly between its ends.
  void walk(End end) {
    if (walked_[end.edge]) return;
    const std::uint32_t start = end.vertex;
    std::vector<End> chain;
    double length = 0;
    while (true) {
      chain.push_back(end);
      walked_[end.edge] = 1;
      length += length_of(edges_[end.edge]);
      const std::uint32_t next = other_vertex(end);
      if (next == start || is_corner(next)) break;
      const auto ends = ends_at(next);
      end = ends[0].edge == end.edge ? ends[1] : ends[0];
      if (walked_[end.edge]) break;
    }
    const double count = std::ceil(length / (kSpacing * radius_));
    const double step = length / count;
    double wanted = step, passed = 0;
    for (const End& piece : chain) {
      const double own = length_of(edges_[piece.edge]);
      while (wanted <= passed + own && wanted < length - 0.5 * step) {
        add(part_.vertices[piece.vertex] + (wanted - passed) * direction(piece),
            edges_[piece.edge].triangle);
        wanted += step;
      }
      passed += own;
    }
  }

  const part::Part& part_;
  const double radius_;
  std::vector<Edge> edges_;
  std::vector<End> ends_;  // by vertex
  std::vector<char> walked_;
  SparseSet chosen_;
  std::vector<part::SurfacePoint> points_;
};

}  // namespace

std::vector<part::SurfacePoint> feature_points(const part::Part& part, double radius) {
  return Network(part, radius).points();
}

}  // namespace forcelayer::sample

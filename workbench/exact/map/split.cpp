#include "workbench/exact/map/split.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

namespace forcelayer::exact {
namespace {

using Place = std::array<float, 3>;
using mesh::Triangle;

double distance_m(const Place& a, const Place& b) {
  return std::hypot(static_cast<double>(a[0]) - b[0], static_cast<double>(a[1]) - b[1],
                    static_cast<double>(a[2]) - b[2]);
}

Place middle_of(const Place& a, const Place& b) {
  Place middle;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    middle[axis] = static_cast<float>(0.5 * (static_cast<double>(a[axis]) + b[axis]));
  }
  return middle;
}

constexpr std::uint32_t kWhole = 0xffffffff;

class Round {
 public:
  Round(SplitMesh& mesh, double edge_m) : mesh_(mesh), edge_m_(edge_m) {}

  // Whether an edge was cut.
  bool cut(const IsNear& is_near) {
    const std::vector<Triangle>& triangles = mesh_.node.triangles;
    for (std::size_t n = 0; n < triangles.size(); ++n) {
      if (!mesh_.is_far[n] && has_long_edge(triangles[n])) mark(n, is_near);
    }
    if (middles_.empty()) return false;
    for (std::size_t n = 0; n < triangles.size(); ++n) replace(triangles[n], mesh_.is_far[n]);
    mesh_.node.triangles = std::move(triangles_);
    mesh_.is_far = std::move(is_far_);
    return true;
  }

 private:
  const Place& place(std::uint32_t vertex) const { return mesh_.node.vertices_m[vertex]; }
  bool is_long(std::uint32_t a, std::uint32_t b) const {
    return distance_m(place(a), place(b)) > edge_m_;
  }
  bool has_long_edge(const Triangle& t) const {
    return is_long(t[0], t[1]) || is_long(t[1], t[2]) || is_long(t[2], t[0]);
  }

  // Notes the long edges of a triangle that matters.
  void mark(std::size_t number, const IsNear& is_near) {
    const Triangle t = mesh_.node.triangles[number];
    Place center;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      center[axis] = (place(t[0])[axis] + place(t[1])[axis] + place(t[2])[axis]) / 3;
    }
    double radius_m = 0;
    for (const std::uint32_t vertex : t) {
      radius_m = std::max(radius_m, distance_m(center, place(vertex)));
    }
    if (!is_near(center, radius_m)) {
      mesh_.is_far[number] = true;
      return;
    }
    for (std::size_t n = 0; n < 3; ++n) {
      const std::uint32_t a = t[n], b = t[(n + 1) % 3];
      if (!is_long(a, b)) continue;
      const auto number_of_new = static_cast<std::uint32_t>(mesh_.node.vertices_m.size());
      if (!middles_.try_emplace(std::minmax(a, b), number_of_new).second) continue;
      mesh_.node.vertices_m.push_back(middle_of(place(a), place(b)));
    }
  }

  std::uint32_t middle(std::uint32_t a, std::uint32_t b) const {
    const auto found = middles_.find(std::minmax(a, b));
    return found == middles_.end() ? kWhole : found->second;
  }

  void add(const Triangle& triangle, char is_far) {
    triangles_.push_back(triangle);
    is_far_.push_back(is_far);
  }

  void replace(Triangle t, char is_far) {
    std::array<std::uint32_t, 3> m{middle(t[0], t[1]), middle(t[1], t[2]), middle(t[2], t[0])};
    const auto cuts = 3 - std::ranges::count(m, kWhole);
    if (cuts == 0) return add(t, is_far);
    if (cuts == 3) {
      add({t[0], m[0], m[2]}, is_far);
      add({m[0], t[1], m[1]}, is_far);
      add({m[2], m[1], t[2]}, is_far);
      return add({m[0], m[1], m[2]}, is_far);
    }
    // Turned until its first edge is cut, and its last one is not.
    while (m[0] == kWhole || m[2] != kWhole) {
      std::rotate(t.begin(), t.begin() + 1, t.end());
      std::rotate(m.begin(), m.begin() + 1, m.end());
    }
    if (cuts == 1) {
      add({t[0], m[0], t[2]}, is_far);
      return add({m[0], t[1], t[2]}, is_far);
    }
    add({m[0], t[1], m[1]}, is_far);
    if (distance_m(place(t[0]), place(m[1])) < distance_m(place(m[0]), place(t[2]))) {
      add({t[0], m[0], m[1]}, is_far);
      return add({t[0], m[1], t[2]}, is_far);
    }
    add({t[0], m[0], t[2]}, is_far);
    add({m[0], m[1], t[2]}, is_far);
  }

  SplitMesh& mesh_;
  double edge_m_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles_;
  std::vector<Triangle> triangles_;
  std::vector<char> is_far_;
};

}  // namespace

void split_edges(SplitMesh& mesh, double edge_m, const IsNear& is_near) {
  while (Round(mesh, edge_m).cut(is_near)) {
  }
}

double longest_edge_m(const mesh::GlbNode& node) {
  double longest_m = 0;
  for (const Triangle& t : node.triangles) {
    for (std::size_t n = 0; n < 3; ++n) {
      longest_m =
          std::max(longest_m, distance_m(node.vertices_m[t[n]], node.vertices_m[t[(n + 1) % 3]]));
    }
  }
  return longest_m;
}

}  // namespace forcelayer::exact

#include "workbench/exact/surface/shells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "pointshell/certificate/ray_winding.h"
#include "pointshell/certificate/winding_number.h"
#include "pointshell/part/mass_properties.h"
#include "pointshell/part/open_edges.h"
#include "pointshell/part/triangle_tree.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::exact {
namespace {

using part::Vec3;

Vec3 corner_m(const Surface& surface, const mesh::Triangle& t, std::size_t n) {
  const glm::dvec3& p = surface.vertices_m[t[n]];
  return {p.x, p.y, p.z};
}

// The triangles, with one number for all corners at one position.
part::Part joined(const Surface& surface) {
  std::map<std::tuple<double, double, double>, std::uint32_t> first;
  part::Part part;
  part.triangles = surface.triangles;
  for (const glm::dvec3& p : surface.vertices_m) part.vertices.push_back({p.x, p.y, p.z});
  for (mesh::Triangle& t : part.triangles) {
    for (std::uint32_t& corner : t) {
      const glm::dvec3& p = surface.vertices_m[corner];
      corner = first.try_emplace({p.x, p.y, p.z}, corner).first->second;
    }
  }
  return part;
}

struct Shell {
  std::vector<std::uint32_t> triangles;
  part::Box box;
  double volume_m3 = 0;  // below 0 where its normals point inwards
};

std::vector<Shell> shells_of(const Surface& surface, const std::vector<std::uint32_t>& piece_of) {
  std::vector<Shell> shells;
  for (std::size_t t = 0; t < piece_of.size(); ++t) {
    if (piece_of[t] >= shells.size()) shells.resize(piece_of[t] + 1);
    Shell& shell = shells[piece_of[t]];
    shell.triangles.push_back(static_cast<std::uint32_t>(t));
    const mesh::Triangle& first = surface.triangles[shell.triangles.front()];
    const Vec3 origin = corner_m(surface, first, 0);
    std::array<Vec3, 3> from;
    for (std::size_t n = 0; n < 3; ++n) {
      const Vec3 corner = corner_m(surface, surface.triangles[t], n);
      shell.box.grow(corner);
      from[n] = corner - origin;
    }
    shell.volume_m3 += part::dot(from[0], part::cross(from[1], from[2])) / 6;
  }
  return shells;
}

std::vector<mesh::Triangle> triangles_of(const part::Part& part, const Shell& shell) {
  std::vector<mesh::Triangle> triangles;
  for (const std::uint32_t t : shell.triangles) triangles.push_back(part.triangles[t]);
  return triangles;
}

bool meet(const part::Box& a, const part::Box& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

bool holds(const part::Box& outer, const part::Box& inner) {
  return outer.low.x <= inner.low.x && inner.high.x <= outer.high.x && outer.low.y <= inner.low.y &&
         inner.high.y <= outer.high.y && outer.low.z <= inner.low.z && inner.high.z <= outer.high.z;
}

// Which shell lies in which.
class Nesting {
 public:
  // `part` has the triangles of the shells. All outlive this.
  Nesting(const part::Part& part, const std::vector<Shell>& shells)
      : part_(part), shells_(shells), trees_(shells.size()) {}

  // The smallest of some closed shells that winds around all corners of another.
  std::optional<std::size_t> around(const std::vector<std::size_t>& closed, std::size_t inner) {
    const Shell& shell = shells_[inner];
    std::optional<std::size_t> found;
    for (const std::size_t n : closed) {
      const Shell& outer = shells_[n];
      const double volume_m3 = std::abs(outer.volume_m3);
      if (n == inner || volume_m3 <= std::abs(shell.volume_m3)) continue;
      if (found && std::abs(shells_[*found].volume_m3) <= volume_m3) continue;
      if (exact::holds(outer.box, shell.box) && holds_corners(n, shell)) found = n;
    }
    return found;
  }

 private:
  bool holds_corners(std::size_t outer, const Shell& inner) {
    if (!trees_[outer]) {
      trees_[outer] = std::make_unique<part::TriangleTree>(part_, shells_[outer].triangles);
    }
    const auto is_held = [&](std::uint32_t corner) {
      const Vec3& place = part_.vertices[corner];
      const auto windings = certificate::windings_by_ray(*trees_[outer], place);
      return windings ? *windings != 0 : std::abs(winding(shells_[outer], place)) > 0.5;
    };
    std::set<std::uint32_t> corners;
    for (const mesh::Triangle& t : triangles_of(part_, inner)) corners.insert(t.begin(), t.end());
    return std::all_of(corners.begin(), corners.end(), is_held);
  }

  double winding(const Shell& shell, const Vec3& place) const {
    double windings = 0;
    for (const std::uint32_t t : shell.triangles) {
      const auto [a, b, c] = part::triangle_piece(part_, t);
      windings += certificate::triangle_winding(place, a, b, c);
    }
    return windings;
  }

  const part::Part& part_;
  const std::vector<Shell>& shells_;
  std::vector<std::unique_ptr<part::TriangleTree>> trees_;  // [shells] empty until asked for
};

// [shells] the number of the body of each, from 0 on. Those that point inwards are cavities.
std::vector<std::uint32_t> bodies_among(const part::Part& part, const std::vector<Shell>& shells) {
  Nesting nesting(part, shells);
  std::vector<std::size_t> outward;
  for (std::size_t n = 0; n < shells.size(); ++n) {
    if (shells[n].volume_m3 >= 0) outward.push_back(n);
  }
  std::vector<std::vector<const part::Box*>> taken;  // of the bodies
  std::vector<std::optional<std::size_t>> inside(shells.size());
  std::vector<std::uint32_t> bodies(shells.size());
  for (std::size_t n = 0; n < shells.size(); ++n) {
    if (shells[n].volume_m3 < 0) inside[n] = nesting.around(outward, n);
    if (inside[n]) continue;
    const auto free = std::find_if(taken.begin(), taken.end(), [&](const auto& boxes) {
      return std::none_of(boxes.begin(), boxes.end(),
                          [&](const part::Box* box) { return meet(*box, shells[n].box); });
    });
    bodies[n] = static_cast<std::uint32_t>(free - taken.begin());
    if (free == taken.end()) taken.emplace_back();
    taken[bodies[n]].push_back(&shells[n].box);
  }
  for (std::size_t n = 0; n < shells.size(); ++n) {
    if (inside[n]) bodies[n] = bodies[*inside[n]];
  }
  return bodies;
}

// Numbers that can be made one.
class Groups {
 public:
  explicit Groups(std::size_t count) : parent_(count) {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t of(std::size_t n) {
    while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
    return n;
  }
  void join(std::size_t a, std::size_t b) { parent_[of(a)] = of(b); }
  // [numbers] the group of each, from 0 on in the order of their first ones.
  std::vector<std::uint32_t> numbers() {
    std::map<std::size_t, std::uint32_t> numbers;
    std::vector<std::uint32_t> all;
    for (std::size_t n = 0; n < parent_.size(); ++n) {
      const auto next = static_cast<std::uint32_t>(numbers.size());
      all.push_back(numbers.try_emplace(of(n), next).first->second);
    }
    return all;
  }

 private:
  std::vector<std::size_t> parent_;
};

// [pieces] the number of its shell: open pieces are joined where one has an open edge within
// `reach_m` of an end of one of another.
std::vector<std::uint32_t> joined_over_cracks(const part::Part& part,
                                              const std::vector<std::uint32_t>& piece_of,
                                              double reach_m) {
  std::map<std::uint32_t, std::uint32_t> piece_at;  // [corner]
  for (std::size_t t = 0; t < piece_of.size(); ++t) {
    for (const std::uint32_t corner : part.triangles[t]) piece_at[corner] = piece_of[t];
  }
  part::Part edges;
  edges.vertices = part.vertices;
  for (const auto& [edge, balance] : part::open_edges_of(part.triangles)) {
    edges.triangles.push_back({edge.first, edge.second, edge.second});
  }
  Groups groups(*std::max_element(piece_of.begin(), piece_of.end()) + std::size_t{1});
  if (edges.triangles.empty()) return groups.numbers();
  const part::TriangleTree tree(edges);
  for (const mesh::Triangle& edge : edges.triangles) {
    for (const std::uint32_t end : {edge[0], edge[1]}) {
      const Vec3& place = part.vertices[end];
      tree.visit_near(place, reach_m, [&](std::uint32_t number) {
        const auto [a, b, c] = part::triangle_piece(edges, number);
        const Vec3 foot = part::nearest_on_triangle(place, a, b, c);
        if (part::length(foot - place) > reach_m) return;
        groups.join(piece_at.at(end), piece_at.at(edges.triangles[number][0]));
      });
    }
  }
  return groups.numbers();
}

}  // namespace

std::vector<std::uint32_t> pieces_of(const Surface& surface) {
  Groups groups(surface.triangles.size());
  std::map<std::tuple<std::uint32_t, double, double, double>, std::size_t> first;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (const auto corner : surface.triangles[t]) {
      const glm::dvec3& p = surface.vertices_m[corner];
      const auto [at, is_new] = first.try_emplace({surface.object[t], p.x, p.y, p.z}, t);
      if (!is_new) groups.join(t, at->second);
    }
  }
  return groups.numbers();
}

void turn_outwards(Surface& surface) {
  const std::vector<Shell> shells = shells_of(surface, pieces_of(surface));
  const part::Part part = joined(surface);
  std::map<std::uint32_t, std::vector<std::size_t>> closed;  // by object
  for (std::size_t n = 0; n < shells.size(); ++n) {
    if (!part::is_closed(triangles_of(part, shells[n]))) continue;
    closed[surface.object[shells[n].triangles.front()]].push_back(n);
  }
  Nesting nesting(part, shells);
  for (auto& [object, of_object] : closed) {
    const auto is_inward = [&](std::size_t n) { return shells[n].volume_m3 < 0; };
    if (std::none_of(of_object.begin(), of_object.end(), is_inward)) continue;
    // The outer ones first.
    std::stable_sort(of_object.begin(), of_object.end(), [&](std::size_t a, std::size_t b) {
      return std::abs(shells[a].volume_m3) > std::abs(shells[b].volume_m3);
    });
    std::vector<bool> is_cavity(shells.size());
    for (const std::size_t n : of_object) {
      const auto outer = nesting.around(of_object, n);
      is_cavity[n] = outer && !is_cavity[*outer] && is_inward(n) != is_inward(*outer);
      if (is_inward(n) == is_cavity[n]) continue;
      for (const std::uint32_t t : shells[n].triangles) {
        std::swap(surface.triangles[t][1], surface.triangles[t][2]);
      }
    }
  }
}

std::vector<std::uint32_t> shells_apart(const Surface& surface, double crack_m) {
  const part::Part part = joined(surface);
  std::vector<std::uint32_t> shell_of = pieces_of(surface);
  if (!part::is_closed(part.triangles)) {
    if (crack_m == 0) return std::vector<std::uint32_t>(shell_of.size());
    // A crack is found by what it changes of the winding number: it may be wider than `crack_m`.
    const auto joined = joined_over_cracks(part, shell_of, 2 * crack_m);
    for (std::uint32_t& number : shell_of) number = joined[number];
  }
  const auto bodies = bodies_among(part, shells_of(surface, shell_of));
  for (std::uint32_t& number : shell_of) number = bodies[number];
  return shell_of;
}

}  // namespace forcelayer::exact

#include "workbench/exact/surface/shells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <tuple>

#include "pointshell/part/mass_properties.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::exact {
namespace {

using part::Vec3;

Vec3 corner_m(const Surface& surface, const mesh::Triangle& t, std::size_t n) {
  const glm::dvec3& p = surface.vertices_m[t[n]];
  return {p.x, p.y, p.z};
}

// Corners at one position have one number.
std::vector<mesh::Triangle> joined(const Surface& surface) {
  std::map<std::tuple<double, double, double>, std::uint32_t> first;
  std::vector<mesh::Triangle> triangles = surface.triangles;
  for (mesh::Triangle& t : triangles) {
    for (std::uint32_t& corner : t) {
      const glm::dvec3& p = surface.vertices_m[corner];
      corner = first.try_emplace({p.x, p.y, p.z}, corner).first->second;
    }
  }
  return triangles;
}

struct Shell {
  std::vector<std::size_t> triangles;
  part::Box box;
  double volume_m3 = 0;  // below 0 where its normals point inwards
};

std::vector<Shell> shells_of(const Surface& surface, const std::vector<std::uint32_t>& piece_of) {
  std::vector<Shell> shells;
  for (std::size_t t = 0; t < piece_of.size(); ++t) {
    if (piece_of[t] >= shells.size()) shells.resize(piece_of[t] + 1);
    Shell& shell = shells[piece_of[t]];
    shell.triangles.push_back(t);
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

// How often a closed shell winds around a place away from it: the sum of the solid angles of its
// triangles (Van Oosterom and Strackee 1983).
double winding(const Surface& surface, const Shell& shell, const Vec3& place) {
  double angle = 0;
  for (const std::size_t t : shell.triangles) {
    std::array<Vec3, 3> r;
    std::array<double, 3> length;
    for (std::size_t n = 0; n < 3; ++n) {
      r[n] = corner_m(surface, surface.triangles[t], n) - place;
      length[n] = part::length(r[n]);
    }
    const double over = part::dot(r[0], part::cross(r[1], r[2]));
    const double under = length[0] * length[1] * length[2] + part::dot(r[0], r[1]) * length[2] +
                         part::dot(r[1], r[2]) * length[0] + part::dot(r[2], r[0]) * length[1];
    angle += 2 * std::atan2(over, under);
  }
  return angle / (4 * std::numbers::pi);
}

bool meet(const part::Box& a, const part::Box& b) {
  return a.low.x <= b.high.x && b.low.x <= a.high.x && a.low.y <= b.high.y && b.low.y <= a.high.y &&
         a.low.z <= b.high.z && b.low.z <= a.high.z;
}

// The smallest shell that winds around another one.
std::optional<std::size_t> around(const Surface& surface, const std::vector<Shell>& shells,
                                  const std::vector<std::size_t>& of_object, std::size_t inner) {
  const Vec3 place = corner_m(surface, surface.triangles[shells[inner].triangles.front()], 0);
  std::optional<std::size_t> found;
  for (const std::size_t n : of_object) {
    const Shell& shell = shells[n];
    if (shell.volume_m3 < 0 || !meet(shell.box, shells[inner].box)) continue;
    if (found && shells[*found].volume_m3 <= shell.volume_m3) continue;
    if (winding(surface, shell, place) > 0.5) found = n;
  }
  return found;
}

// [shells] the number of the body of each of these, from 0 on.
std::vector<std::size_t> bodies_among(const Surface& surface, const std::vector<Shell>& shells,
                                      const std::vector<std::size_t>& of_object) {
  struct Taken {
    bool is_inward;
    std::vector<const part::Box*> boxes;
  };
  std::vector<Taken> taken;
  std::vector<std::optional<std::size_t>> inside(of_object.size());
  std::map<std::size_t, std::size_t> body_of;
  for (std::size_t i = 0; i < of_object.size(); ++i) {
    const Shell& shell = shells[of_object[i]];
    const bool is_inward = shell.volume_m3 < 0;
    if (is_inward) inside[i] = around(surface, shells, of_object, of_object[i]);
    if (inside[i]) continue;
    const auto free = std::find_if(taken.begin(), taken.end(), [&](const Taken& body) {
      return body.is_inward == is_inward &&
             std::none_of(body.boxes.begin(), body.boxes.end(),
                          [&](const part::Box* box) { return meet(*box, shell.box); });
    });
    body_of[of_object[i]] = static_cast<std::size_t>(free - taken.begin());
    if (free == taken.end()) {
      taken.push_back({is_inward, {&shell.box}});
    } else {
      free->boxes.push_back(&shell.box);
    }
  }
  std::vector<std::size_t> bodies;
  for (std::size_t i = 0; i < of_object.size(); ++i) {
    bodies.push_back(body_of.at(inside[i].value_or(of_object[i])));
  }
  return bodies;
}

}  // namespace

std::vector<std::uint32_t> pieces_of(const Surface& surface) {
  std::vector<std::size_t> parent(surface.triangles.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto root = [&](std::size_t t) {
    while (parent[t] != t) t = parent[t] = parent[parent[t]];
    return t;
  };
  std::map<std::tuple<std::uint32_t, double, double, double>, std::size_t> first;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    for (const auto corner : surface.triangles[t]) {
      const glm::dvec3& p = surface.vertices_m[corner];
      const auto [at, is_new] = first.try_emplace({surface.object[t], p.x, p.y, p.z}, t);
      if (!is_new) parent[root(t)] = root(at->second);
    }
  }
  std::map<std::size_t, std::uint32_t> numbers;
  std::vector<std::uint32_t> pieces;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto number = static_cast<std::uint32_t>(numbers.size());
    pieces.push_back(numbers.try_emplace(root(t), number).first->second);
  }
  return pieces;
}

std::vector<std::uint32_t> shells_apart(const Surface& surface) {
  const std::vector<Shell> shells = shells_of(surface, pieces_of(surface));
  const std::vector<mesh::Triangle> triangles = joined(surface);
  std::map<std::uint32_t, std::vector<std::size_t>> by_object;
  for (std::size_t n = 0; n < shells.size(); ++n) {
    by_object[surface.object[shells[n].triangles.front()]].push_back(n);
  }
  const auto is_closed = [&](std::size_t n) {
    std::vector<mesh::Triangle> own;
    for (const std::size_t t : shells[n].triangles) own.push_back(triangles[t]);
    return part::is_closed(own);
  };
  std::vector<std::uint32_t> body_of(surface.triangles.size());
  std::uint32_t count = 0;
  for (const auto& [object, of_object] : by_object) {
    std::vector<std::size_t> bodies(of_object.size());
    if (of_object.size() > 1 && std::all_of(of_object.begin(), of_object.end(), is_closed)) {
      bodies = bodies_among(surface, shells, of_object);
    }
    for (std::size_t i = 0; i < of_object.size(); ++i) {
      for (const std::size_t t : shells[of_object[i]].triangles) {
        body_of[t] = count + static_cast<std::uint32_t>(bodies[i]);
      }
    }
    count += static_cast<std::uint32_t>(*std::max_element(bodies.begin(), bodies.end())) + 1;
  }
  return body_of;
}

}  // namespace forcelayer::exact

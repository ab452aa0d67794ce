// A box as triangles of a surface.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <initializer_list>
#include <utility>

#include "workbench/exact/surface/surfaces.h"

namespace forcelayer::test {

// Adds a box with normals that point outwards, or inwards. `largest_m` stays.
inline void add_box(exact::Surface& surface, const glm::dvec3& low_m, const glm::dvec3& high_m,
                    std::uint32_t object = 1, bool is_inward = false) {
  const auto first = static_cast<std::uint32_t>(surface.vertices_m.size());
  for (int n = 0; n < 8; ++n) {
    surface.vertices_m.emplace_back((n & 1 ? high_m : low_m).x, (n & 2 ? high_m : low_m).y,
                                    (n & 4 ? high_m : low_m).z);
  }
  for (mesh::Triangle t : std::initializer_list<mesh::Triangle>{{0, 2, 1},
                                                                {1, 2, 3},
                                                                {4, 5, 6},
                                                                {5, 7, 6},
                                                                {0, 1, 4},
                                                                {1, 5, 4},
                                                                {2, 6, 3},
                                                                {3, 6, 7},
                                                                {0, 4, 2},
                                                                {2, 4, 6},
                                                                {1, 3, 5},
                                                                {3, 7, 5}}) {
    if (is_inward) std::swap(t[1], t[2]);
    surface.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    surface.object.push_back(object);
  }
}

}  // namespace forcelayer::test

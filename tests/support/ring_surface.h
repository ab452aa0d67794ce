// The sides of a prism along z, without its ends: a ring of slivers.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "workbench/exact/surface/surfaces.h"

namespace forcelayer::test {

// Vertices 2 n and 2 n + 1 are the lower and the upper end of edge n.
inline exact::Surface ring_surface(int sides, double radius_m, double half_m) {
  exact::Surface surface;
  for (int n = 0; n < sides; ++n) {
    const double turn = 2 * std::numbers::pi * n / sides;
    for (const double z : {-half_m, half_m}) {
      surface.vertices_m.push_back({radius_m * std::cos(turn), radius_m * std::sin(turn), z});
    }
  }
  const auto count = static_cast<std::uint32_t>(2 * sides);
  for (std::uint32_t a = 0; a < count; a += 2) {
    const std::uint32_t b = (a + 2) % count;
    surface.triangles.push_back({a, b, a + 1});
    surface.triangles.push_back({b, b + 1, a + 1});
  }
  surface.object.assign(surface.triangles.size(), 1);
  return surface;
}

}  // namespace forcelayer::test

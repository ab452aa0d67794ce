// The distance between two triangles. It is in error by a few units in the last place of the
// largest coordinate, whatever the triangles' size and shape: slivers and triangles without area
// too.
//
// Each candidate is the distance of two places that lie in the triangles, so none is too small. The
// least is not too large either: where rounding moves a place of a sliver or of a pair of nearly
// parallel edges far, the distance changes little there (triangle_distance.cpp).
#pragma once

#include <array>
#include <glm/vec3.hpp>

namespace forcelayer::exact {

using Corners = std::array<glm::dvec3, 3>;

struct TriangleDistance {
  double distance_m = 0;         // 0 where they meet
  glm::dvec3 first_m, second_m;  // the nearest places; where they meet, one of both
};

TriangleDistance triangle_distance(const Corners& first, const Corners& second);

}  // namespace forcelayer::exact

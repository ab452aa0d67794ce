// The area that each shell point stands for.
#pragma once

#include <span>
#include <vector>

#include "pointshell/part.h"
#include "pointshell/vec3.h"

namespace forcelayer {

// For each of `points`, the area of the surface that is nearer to it than to any other (its Voronoi
// cell restricted to the surface), m^2. The sum is the part's area up to rounding. Every surface
// point must be within `radius` of a point.
std::vector<double> area_weights(const Part& part, std::span<const Vec3> points, double radius);

}  // namespace forcelayer

// The area that each shell point stands for.
#pragma once

#include <span>
#include <vector>

#include "pointshell/part/vec3.h"
#include "pointshell/sample/restricted_cells.h"

namespace forcelayer {

// For each of `points`, the area of the surface that is nearer to it than to any other (its
// restricted Voronoi cell), m^2. The sum is the part's area up to rounding where the points cover
// the part within the radius of `cells`, which must have been made for all of them.
std::vector<double> area_weights(const RestrictedCells& cells, std::span<const Vec3> points);

}  // namespace forcelayer

// The area that each shell point stands for.
#pragma once

#include <span>
#include <vector>

#include "pointshell/part/vec3.h"
#include "pointshell/sample/restricted_cells.h"

namespace forcelayer::sample {

// For each of `points`, the area of its restricted Voronoi cell, m^2: the surface that is nearer to
// it than to any other point. `cells` must have been made for all of `points`. Where they cover the
// part within the radius of `cells`, the sum is the part's area up to rounding.
std::vector<double> area_weights(const RestrictedCells& cells, std::span<const part::Vec3> points);

}  // namespace forcelayer::sample

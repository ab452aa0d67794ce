// The area that each shell point stands for.
#pragma once

#include <span>
#include <vector>

#include "pointshell/certificate/hidden_surface.h"
#include "pointshell/part/vec3.h"
#include "pointshell/sample/restricted_cells.h"

namespace forcelayer::sample {

// For each of `points`, the outer area of its restricted Voronoi cell, m^2: the surface that is
// nearer to it than to any other point, and that `hidden` does not have inside another body. Where
// the surface of another body crosses a cell, pieces of about `step` decide by their middle.
// `cells` must have been made for all of `points`. Where they cover the part within the radius of
// `cells`, the sum is the part's outer area, up to rounding and these pieces.
std::vector<double> area_weights(const RestrictedCells& cells, std::span<const part::Vec3> points,
                                 const certificate::HiddenSurface& hidden, double step);

}  // namespace forcelayer::sample

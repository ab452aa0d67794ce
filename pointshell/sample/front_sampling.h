// Spreading points over a surface in hexagons that grow from where points stand already.
#pragma once

#include <span>
#include <vector>

#include "pointshell/part/triangle_tree.h"

namespace forcelayer::sample {

// Points on the surface of `tree`'s part. Most are `spacing` (m) from six others; no two are closer
// than about 0.8 spacings, and no bare patch is larger than that. Where fronts meet, rows do not
// fit and points stand closer or farther; the relaxation mends that.
//
// The part is cut into cubes, which are filled in eight turns. Cubes of one turn do not touch, and
// each cube continues the rows of its finished neighbors. So the result is the same for any number
// of threads.
// Fronts grow from `given` points as well, and keep off them; the result is without them.
std::vector<part::SurfacePoint> hexagonal_front(const part::TriangleTree& tree, double spacing,
                                                std::span<const part::SurfacePoint> given);

}  // namespace forcelayer::sample

// Spreading points over a surface in hexagons that grow from where points stand already.
#pragma once

#include <vector>

#include "pointshell/part/triangle_tree.h"

namespace forcelayer {

// Points on the surface of `tree`'s part, most of them `spacing` (m) from six others, none nearer
// to another than about 0.8 of it, with no bare patch larger than that. Where fronts meet, rows do
// not fit and points stand closer or farther: the relaxation mends that.
//
// The part is cut into cubes, worked on in eight turns such that cubes of one turn do not touch;
// each cube continues the rows that its finished neighbors have begun. So the result is the same
// for any number of threads.
std::vector<SurfacePoint> hexagonal_front(const TriangleTree& tree, double spacing);

}  // namespace forcelayer

// Points on the sharp vertices and along the sharp and open edges of a part.
#pragma once

#include <vector>

#include "pointshell/part/part.h"
#include "pointshell/part/triangle_tree.h"

namespace forcelayer::sample {

// Without points on an edge the points' convex hull cuts it off, and their distances prove little
// there. An edge is sharp where the surface turns by more than 40 degrees, and open where it
// belongs to one triangle of its body; chains of such edges that are short
// against the covering radius `radius` (m) are roughness of a scan. Points stand where chains end,
// meet or turn, and evenly in between.
std::vector<part::SurfacePoint> feature_points(const part::Part& part, double radius);

}  // namespace forcelayer::sample

// How often triangles wind around a point, counted along one ray.
#pragma once

#include <optional>

#include "pointshell/part/triangle_tree.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::certificate {

// How often the triangles of `tree` wind around a point, m, counted where a ray from it crosses
// them: exact where each of their edges is closed. None where the ray comes so near an edge that
// rounding decides. A ray meets some dozens of boxes, where a WindingNumber opens thousands.
std::optional<int> windings_by_ray(const part::TriangleTree& tree, const part::Vec3& point);

// Whether that ray from a point comes within `radius` of one of some edges (triangles with two
// equal corners).
bool is_ray_within(const part::TriangleTree& edges, const part::Vec3& point, double radius);

}  // namespace forcelayer::certificate

// The order of shell points and their grouping into blocks and super-blocks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/pshell_format.h"
#include "pointshell/vec3.h"

namespace forcelayer {

// Indices of `points` along a Hilbert curve through their bounding cube (Skilling, "Programming the
// Hilbert curve", 2004; 21 bits an axis). Points in one cell of the curve are in lexicographic
// order, so that the order depends on the set of points alone.
std::vector<std::uint32_t> hilbert_order(std::span<const Vec3> points);

// The smallest spheres around each `group` successive points, rounded so that they hold them.
// Positions must be floats.
std::vector<BoundingSphere> bounding_spheres(std::span<const Vec3> points, std::size_t group);

}  // namespace forcelayer

// Drawing of a triangle that is not small: finds the bricks of the node that it hits, then the
// voxels brick by brick, cells in vector lanes. Its slow twin is TriangleOverlap, which finds the
// same voxels.
#pragma once

#include <cstdint>

#include "formats/lattice/voxel_overlap.h"
#include "voxelize/scan/node_canvas.h"

namespace forcelayer::scan {

// Up to this extent along every axis (512 voxels), 64 bits hold every value of the tests.
inline constexpr std::int64_t kLargeTriangleUnits = std::int64_t{1} << 19;

// Draws a triangle of at most that extent. Corners in lattice units from the node's lowest corner.
void draw_large_triangle(const lattice::LatticeTriangle& corners, NodeCanvas& canvas);

}  // namespace forcelayer::scan

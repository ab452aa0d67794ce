// How far a voxel's centre is from a triangle, decided in exact integer arithmetic.
#pragma once

#include "formats/mesh/voxel_overlap.h"

namespace forcelayer {

// Whether the centre of `voxel` is less than `radius_units` lattice units (1 to 2^15) from
// `triangle`.
bool center_is_nearer(const LatticeTriangle& triangle, const VoxelIndex& voxel,
                      std::int64_t radius_units);

}  // namespace forcelayer

// How far a voxel is from a triangle, decided in exact integer arithmetic.
#pragma once

#include "formats/mesh/voxel_overlap.h"

namespace forcelayer {

// Whether the closed cube of `voxel` has a point less than `radius_voxels` (1 or more) from
// `triangle`. The triangle must not pass through the half-open voxel: where it does, the answer may
// be either.
bool comes_nearer(const LatticeTriangle& triangle, const VoxelIndex& voxel, int radius_voxels);

}  // namespace forcelayer

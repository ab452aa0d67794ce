// G: the voxels that an object's surface passes through.
#pragma once

#include <memory>

#include "voxelize/masks/mask_tree.h"
#include "voxelize/scan/snap.h"

namespace forcelayer::scan {

// Exactly the half-open voxels that hold a point of a triangle, as leaves, counted from
// `scene_origin` (a multiple of 512 voxels). Parallel over 64^3-voxel nodes.
std::unique_ptr<masks::MaskTree> scan_convert(const SnappedObject& object,
                                              const lattice::VoxelIndex& scene_origin);

}  // namespace forcelayer::scan

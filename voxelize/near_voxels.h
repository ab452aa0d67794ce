// The Euclidean growth of a surface: what offset layers start from with --metric euclidean.
#pragma once

#include <memory>

#include "voxelize/mask_tree.h"
#include "voxelize/snap.h"

namespace forcelayer {

// `geometry` (the voxels that the object passes through) and, of the voxels outside `interior`,
// those whose closed cube has a point less than `radius_voxels` (1..32) from the object's surface.
// Decided exactly.
std::unique_ptr<MaskTree> near_voxels(const SnappedObject& object, const MaskTree& geometry,
                                      const MaskTree& interior, int radius_voxels,
                                      const VoxelIndex& scene_origin);

}  // namespace forcelayer

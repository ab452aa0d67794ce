// The Euclidean growth of a surface: what offset layers start from with --metric euclidean.
#pragma once

#include <memory>

#include "voxelize/masks/mask_tree.h"
#include "voxelize/scan/snap.h"

namespace forcelayer {

// The centres of the voxels that are interior with `layers` (k, 1 to kMaxBakedLayers) Euclidean
// layers are nearer than this to the surface, lattice units: k - 1 voxels, half a diagonal, and a
// little (voxmap_format.md, section 5).
constexpr std::int64_t interior_radius_units(int layers) { return (layers - 1) * kSnapUnits + 888; }

// The voxels outside `interior` whose centres are less than interior_radius_units() from the
// object's surface, those that it passes through among them. Decided exactly.
std::unique_ptr<MaskTree> near_voxels(const SnappedObject& object, const MaskTree& interior,
                                      int layers, const VoxelIndex& scene_origin);

}  // namespace forcelayer

// The difference between two bakes.
#pragma once

#include "formats/result.h"
#include "workbench/viewer/surface/quad_surface.h"

namespace forcelayer::viewer {

// Voxels of one value in two maps of one lattice.
struct LayerChange {
  std::uint64_t added = 0;    // in `after` only
  std::uint64_t removed = 0;  // in `before` only
  std::uint64_t kept = 0;     // in both
  QuadSurface added_surface, removed_surface;
};

// The change of `layer` from `before` to `after`. Error: kFilesDoNotMatch where the voxel sizes
// differ (equal ones share the world's lattice).
Result<LayerChange> layer_change(const Voxmap& before, const Voxmap& after, VoxelValue layer,
                                 const glm::dvec3& origin_m);

}  // namespace forcelayer::viewer

// The surfaces of a voxmap's layers, and cuts through them.
#pragma once

#include "workbench/viewer/surface/quad_surface.h"
#include "workbench/viewer/surface/shown_voxels.h"

namespace forcelayer::viewer {

// Whether `a` lies further out than `b`, in the order interior, surface, proximity, free.
bool lies_further_out(VoxelValue a, VoxelValue b);

// The faces at which `layer` (interior, surface or proximity) borders on a value further out: a
// face belongs to the voxel further in. `origin_m`: world point that corners are given from. Voxels
// of hidden objects count as free.
QuadSurface layer_surface(const Voxmap& voxmap, VoxelValue layer, const glm::dvec3& origin_m,
                          Faces faces = Faces::kMerged, const HiddenObjects& hidden = {});

// The voxels of value `layer` with world index `index` along `axis`, as one sheet through their
// upper (`side` 1) or lower (-1) faces, as a cut there shows them.
QuadSurface slice_surface(const Voxmap& voxmap, VoxelValue layer, int axis, std::int64_t index,
                          int side, const glm::dvec3& origin_m, const HiddenObjects& hidden = {});

}  // namespace forcelayer::viewer

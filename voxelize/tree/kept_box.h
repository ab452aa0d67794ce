// What a region of interest leaves of a tree.
#pragma once

#include <openvdb/math/Coord.h>

#include <cstdint>

#include "voxelize/scan/snap.h"
#include "voxelize/tree/built_tree.h"
#include "voxelize/tree/sharing.h"

namespace forcelayer {

// The voxels of the scene that are kept: all that are not free, unless sides are cropped.
struct KeptBox {
  openvdb::math::CoordBBox box;     // counted from the scene's origin
  std::uint32_t cropped_sides = 0;  // CroppedSide bits

  bool cropped() const { return cropped_sides != 0; }
};

// Clearance ends where nothing is known: at most the distance to what lies beyond a cropped side,
// and 0 (unknown) for entries that reach beyond one.
void clip_clearance(BuiltTree& tree, const KeptBox& kept);

// The smallest box of all voxels that are not free, counted from the scene's origin; empty where
// there are none. `free_code` is the code of free voxels.
VoxelBox tight_box(const VoxelTree& tree, const std::array<std::uint32_t, 3>& directory_dims,
                   std::uint32_t bits = 2, std::uint32_t free_code = 0);

}  // namespace forcelayer

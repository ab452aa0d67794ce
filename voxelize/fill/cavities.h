// The connected pieces of an object's interior: how large each is, and a point in it from which a
// free seed would open it.
#pragma once

#include <cstdint>
#include <vector>

#include "voxelize/masks/mask_tree.h"

namespace forcelayer::fill {

struct InteriorPiece {
  std::uint64_t voxels = 0;
  masks::Coord seed;  // a voxel of the piece, deep inside a large one; counted as the tree's voxels
};

// The 6-connected pieces of `interior`, the largest first, then by seed.
std::vector<InteriorPiece> interior_pieces(const masks::MaskTree& interior);

}  // namespace forcelayer::fill

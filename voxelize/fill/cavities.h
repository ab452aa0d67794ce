// The connected pieces of an object's interior: how large each is, and a point in it from which a
// free seed would open it.
#pragma once

#include <cstdint>
#include <vector>

#include "voxelize/masks/mask_tree.h"

namespace forcelayer {

struct InteriorPiece {
  std::uint64_t voxels = 0;
  Coord seed;  // a voxel of the piece, deep inside a large one; counted as the tree's voxels
};

// The 6-connected pieces of `interior`, the largest first, then by seed.
std::vector<InteriorPiece> interior_pieces(const MaskTree& interior);

// A piece as a bake reports it: solid metal, or the inside of a closed shell. The voxels alone
// cannot tell which; a free seed opens it.
struct Cavity {
  std::uint64_t voxels = 0;
  VoxelIndex seed_voxel{};  // world voxel index; its center is a point inside
  // At half the voxel size the outside reaches it: a gap narrower than a voxel closed it.
  bool opens_at_half_size = false;
};
inline constexpr std::size_t kMaxReportedCavities = 64;  // of an object

}  // namespace forcelayer

// A cavity of an object as reports and caches hold it.
#pragma once

#include <cstddef>
#include <cstdint>

#include "formats/lattice/voxel_overlap.h"

namespace forcelayer::fill {

// A connected piece of an object's interior: solid metal, or the inside of a closed shell. The
// voxels alone cannot tell which; a free seed opens it.
struct Cavity {
  std::uint64_t voxels = 0;
  lattice::VoxelIndex seed_voxel{};  // world voxel index; its center is a point inside
  // At half the voxel size the outside reaches it: a gap narrower than a voxel closed it.
  bool opens_at_half_size = false;
};
inline constexpr std::size_t kMaxReportedCavities = 64;  // of an object

}  // namespace forcelayer::fill

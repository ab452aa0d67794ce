#include "voxelize/masks/voxel_box.h"

#include <algorithm>

namespace forcelayer::masks {

void VoxelBox::include(const VoxelBox& other) {
  for (std::size_t d = 0; d < 3; ++d) {
    low[d] = std::min(low[d], other.low[d]);
    high[d] = std::max(high[d], other.high[d]);
  }
}

VoxelBox VoxelBox::grown(std::int64_t voxels) const {
  VoxelBox box = *this;
  for (std::size_t d = 0; d < 3 && !empty(); ++d) {
    box.low[d] -= voxels;
    box.high[d] += voxels;
  }
  return box;
}

VoxelBox VoxelBox::shifted(const lattice::VoxelIndex& by) const {
  VoxelBox box = *this;
  for (std::size_t d = 0; d < 3 && !empty(); ++d) {
    box.low[d] += by[d];
    box.high[d] += by[d];
  }
  return box;
}

VoxelBox VoxelBox::joined(const VoxelBox& other) const {
  VoxelBox box = *this;
  box.include(other);
  return box;
}

bool VoxelBox::overlaps(const VoxelBox& other) const {
  for (std::size_t d = 0; d < 3; ++d) {
    if (low[d] > other.high[d] || other.low[d] > high[d]) return false;
  }
  return true;
}

}  // namespace forcelayer::masks

// Boxes and indices of voxels.
#pragma once

#include <openvdb/math/Coord.h>

#include <cstdint>

#include "formats/lattice/voxel_overlap.h"

namespace forcelayer::masks {

// In world voxel indices, `high` inclusive; empty where low > high.
struct VoxelBox {
  lattice::VoxelIndex low{INT64_MAX, INT64_MAX, INT64_MAX};
  lattice::VoxelIndex high{INT64_MIN, INT64_MIN, INT64_MIN};

  bool empty() const { return low[0] > high[0]; }
  void include(const VoxelBox& other);
  VoxelBox grown(std::int64_t voxels) const;
  VoxelBox shifted(const lattice::VoxelIndex& by) const;
  VoxelBox joined(const VoxelBox& other) const;
  bool overlaps(const VoxelBox& other) const;
};

// The voxels of the scene that a bake keeps: all that are not free, unless sides are cropped.
struct KeptBox {
  openvdb::math::CoordBBox box;     // counted from the scene's origin
  std::uint32_t cropped_sides = 0;  // CroppedSide bits

  bool cropped() const { return cropped_sides != 0; }
};

// Hashes indices of voxels, nodes or directory cells.
struct IndexHash {
  std::size_t operator()(const lattice::VoxelIndex& index) const {
    std::uint64_t hash = 0;
    for (const std::int64_t x : index) {
      hash = (hash ^ static_cast<std::uint64_t>(x)) * 0x9e3779b97f4a7c15u;
      hash ^= hash >> 32;
    }
    return hash;
  }
};

}  // namespace forcelayer::masks

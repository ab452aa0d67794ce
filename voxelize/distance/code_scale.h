// The distances that the codes of a map stand for (formats/voxmap_format.md, section 6).
#pragma once

#include <cstdint>

namespace forcelayer::distance {

// The range of --range, in voxels: how deep below the zero-force surface distances are stored. They
// are stored at least down to the mesh; the default goes deeper.
inline constexpr double kMinRangeVoxels = 2, kMaxRangeVoxels = 32, kUsualRangeVoxels = 4;

// How far in front of the zero-force surface distances are stored, in voxels. A force reads codes
// of centers up to 2.12 voxels beyond the eight around its point, which are up to sqrt(3)/2 from
// the point. Clearances are measured up to here.
inline constexpr double kOutsideVoxels = 3;

// Lengths in voxels, distances from the static surface. Code c stands for distances from
// (c - zero_code) quantum to a quantum more. Code 0 also stands for all lesser distances, code 255
// for all greater ones.
struct CodeScale {
  double zero_force = 0;   // the zero-force surface
  double force_depth = 0;  // from there down to the interior: 1, or the compliance's depth
  double quantum = 0;
  std::int32_t zero_code = 0;

  double min_of(std::int32_t code) const { return (code - zero_code) * quantum; }
};

// The interior ends `interior_radius_units` lattice units from the surface; `force_depth_voxels` is
// above 0, and a voxel less than the range.
CodeScale code_scale(std::int64_t interior_radius_units, double range_voxels,
                     double force_depth_voxels);

}  // namespace forcelayer::distance

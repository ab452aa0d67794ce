// The distances that the codes of a map stand for (formats/voxmap_format.md, section 6).
#pragma once

#include <cstdint>

namespace forcelayer::distance {

// How deep distances are kept, in voxels below the zero-force surface, and at least down to the
// mesh. The default reaches beyond it.
inline constexpr double kLeastRangeVoxels = 2, kMostRangeVoxels = 32, kUsualRangeVoxels = 4;

// How far distances are kept in front of the zero-force surface, in voxels. A force reads the codes
// of centers up to 2.12 voxels beyond the eight around its point, and those are up to sqrt(3)/2
// from it; the clearance is told up to here.
inline constexpr double kOutsideVoxels = 3;

// Lengths in voxels, distances from the static surface. Code c stands for distances from
// (c - zero_code) quantum to a quantum more; code 0 for those and all below, code 255 for all
// above.
struct CodeScale {
  double zero_force = 0;   // the zero-force surface
  double force_depth = 0;  // from there down to the interior: 1, or as deep as the compliance
  double quantum = 0;
  std::int32_t zero_code = 0;

  double least_of(std::int32_t code) const { return (code - zero_code) * quantum; }
};

// The interior ends `interior_radius_units` lattice units from the surface; `force_depth_voxels` is
// above 0, and a voxel less than the range.
CodeScale code_scale(std::int64_t interior_radius_units, double range_voxels,
                     double force_depth_voxels);

}  // namespace forcelayer::distance

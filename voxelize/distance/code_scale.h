// The distance that each code of 4 or 8 bits stands for (formats/voxmap_format.md, section 6).
#pragma once

#include <cstdint>

namespace forcelayer::distance {

inline constexpr double kLeastRangeVoxels = 2, kMostRangeVoxels = 32;
// The default: as deep as the force layer is felt, and at 8 bits beyond the mesh itself.
constexpr double default_range_voxels(std::uint32_t bits) { return bits == 8 ? 4 : 2; }

// Lengths in voxels, distances from the static surface.
struct CodeScale {
  std::uint32_t bits = 0;
  double zero = 0;            // of the zero-force surface
  double layer = 0;           // from there down to the interior: 1, or as deep as the compliance
  double interior_below = 0;  // Table 1 by distance of a voxel's center
  double surface_below = 0;
  double proximity_below = 0;
  double range = 0;
  double quantum = 0;
  std::uint32_t zero_code = 0, surface_code = 0, proximity_code = 0, free_code = 0;
};

// `layers` at least 1, `bits` 4 or 8, `layer_voxels` at least 1 and a voxel less than the range.
CodeScale code_scale(std::uint32_t layers, std::uint32_t bits, double range_voxels,
                     double layer_voxels = 1);

}  // namespace forcelayer::distance

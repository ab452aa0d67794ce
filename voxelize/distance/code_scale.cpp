#include "voxelize/distance/code_scale.h"

#include <cmath>

#include "voxelize/distance/distance_kernel.h"

namespace forcelayer::distance {
namespace {

// From a voxel's center to its corners.
const double kHalfDiagonal = std::sqrt(3.0) / 2;

// A point lies between eight voxel centers. Their mean distance from the nearest of them, by
// trilinear weights, is at most this: at the voxel's corner.
const double kMeanReach = (3 + 3 * std::sqrt(2.0) + std::sqrt(3.0)) / 8;

}  // namespace

CodeScale code_scale(std::uint32_t layers, std::uint32_t bits, double range_voxels,
                     double layer_voxels) {
  CodeScale scale;
  scale.bits = bits;
  scale.range = range_voxels;
  scale.interior_below = layers - 1 + kHalfDiagonal + double{kDistanceErrorVoxels};
  scale.layer = layer_voxels;
  scale.zero = scale.interior_below + layer_voxels;
  const std::uint32_t highest = (1u << bits) - 1;
  scale.free_code = highest;
  // The finest quantum of which a whole number of steps leads from the zero force to the range,
  // with codes left for the proximity voxels; at 8 bits, for their distances.
  for (std::uint32_t steps = highest; steps > 0; --steps) {
    const double quantum = range_voxels / steps;
    const double surface = kMeanReach + quantum;  // outside the zero force
    const double kept = bits == 8 ? surface + 2 * kHalfDiagonal : surface + quantum;
    const auto up = [&](double distance) {
      return steps + static_cast<std::uint32_t>(std::ceil(distance / quantum));
    };
    if (up(kept) > highest) continue;
    scale.quantum = quantum;
    scale.zero_code = steps;
    scale.surface_code = steps - static_cast<std::uint32_t>(std::lround(layer_voxels / quantum));
    scale.proximity_code = up(surface);
    scale.surface_below = scale.zero + surface;
    break;
  }
  // No free voxel touches one of the force layer.
  scale.proximity_below = scale.surface_below + 2 * kHalfDiagonal;
  return scale;
}

}  // namespace forcelayer::distance

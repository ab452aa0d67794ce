#include "voxelize/distance/code_scale.h"

#include <algorithm>
#include <cmath>

#include "formats/lattice/voxel_overlap.h"
#include "formats/voxmap_format.h"

namespace forcelayer::distance {

CodeScale code_scale(std::int64_t interior_radius_units, double range_voxels,
                     double force_depth_voxels) {
  CodeScale scale;
  const double interior =
      static_cast<double>(interior_radius_units) / static_cast<double>(lattice::kSnapUnits);
  scale.force_depth = force_depth_voxels;
  scale.zero_force = interior + force_depth_voxels;
  const double range = std::max(range_voxels, scale.zero_force);
  // One code is lost to rounding at either end.
  scale.quantum = (range + kOutsideVoxels) / (kMaxDistanceCode - 2);
  scale.zero_code =
      1 - static_cast<std::int32_t>(std::floor((scale.zero_force - range) / scale.quantum));
  return scale;
}

}  // namespace forcelayer::distance

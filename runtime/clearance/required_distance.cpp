#include "runtime/clearance/required_distance.h"

#include <algorithm>

#include "runtime/clearance/part_distance.h"

namespace forcelayer::clearance {

RequiredDistance::RequiredDistance(const Voxmap& voxmap, const Pshell& shell, double required_m)
    : terms_(shell.surface_distance_terms()),
      voxel_size_m_(voxmap.voxel_size_m()),
      deviations_m_(voxmap.header().static_deviation_m + shell.header().part_deviation_m +
                    PartDistance(voxmap, shell, {}, 0).rounding_m()),
      voxels_(least_point_distance_for_m(terms_, required_m + deviations_m_) / voxel_size_m_) {}

double RequiredDistance::clearance_m(double voxels) const {
  const double proven = surface_distance_bound_m(terms_, voxels * voxel_size_m_);
  return std::max(0.0, proven - deviations_m_);
}

}  // namespace forcelayer::clearance

#include "runtime/clearance/required_distance.h"

#include <algorithm>
#include <cmath>

#include "runtime/clearance/part_distance.h"

namespace forcelayer::clearance {

namespace {

// A center is the middle of a voxel that the surface, its corners moved by less than 2^-10 voxel,
// passes through.
double off_surface_m(const PshellHeader& header) {
  if (header.method != static_cast<std::uint32_t>(ShellMethod::kVoxelCenters)) return 0;
  return std::sqrt(0.75) * (1 + 0x1p-9) * header.voxel_size_m;
}

}  // namespace

RequiredDistance::RequiredDistance(const Voxmap& voxmap, const Pshell& shell, double required_m)
    : terms_(shell.surface_distance_terms()),
      voxel_size_m_(voxmap.voxel_size_m()),
      deviations_m_(voxmap.header().static_deviation_m + shell.header().part_deviation_m +
                    PartDistance(voxmap, shell, {}, 0).rounding_m()),
      point_off_surface_m_(off_surface_m(shell.header())),
      voxels_(min_point_distance_for_m(terms_, required_m + deviations_m_) / voxel_size_m_) {}

double RequiredDistance::clearance_m(double voxels) const {
  const double proven = surface_distance_bound_m(terms_, voxels * voxel_size_m_);
  return std::max(0.0, proven - deviations_m_);
}

}  // namespace forcelayer::clearance

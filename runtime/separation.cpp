#include "runtime/separation.h"

#include <algorithm>
#include <cmath>

namespace forcelayer {
namespace {

std::optional<double> positive(double bound_m) {
  return bound_m > 0 ? std::optional<double>(bound_m) : std::nullopt;
}

// How far the arc of a point deviates from its chord when nothing travels more than s/2: a point at
// radius r that turns by a deviates by r (1 - cos(a/2)), at most r a^2 / 8 and at most 2r, and the
// part's radius R gives R a <= s/2.
double arc_deviation_m(double voxel_size_m, double radius_m) {
  if (!(radius_m > 0)) return 0;
  return std::min(voxel_size_m * voxel_size_m / (32 * radius_m), 2 * radius_m);
}

}  // namespace

SeparationGuarantee separation_guarantee(const VoxmapHeader& voxmap, const PshellHeader& shell,
                                         double pose_error_m) {
  if (voxmap.offset_layers < 2) return {};
  const double s = voxmap.voxel_size_m;
  const double layers = voxmap.offset_layers - 1.0;
  const double spent_m =
      shell.covering_radius_m + voxmap.static_deviation_m + shell.part_deviation_m + pose_error_m;
  // Half-way along a chord of s/2 a point is s/4 from either end.
  const double chord_m = std::sqrt(layers * layers - 1.0 / 16) * s;
  return {positive(layers * s - spent_m),
          positive(chord_m - spent_m - arc_deviation_m(s, shell.bounding_radius_m))};
}

}  // namespace forcelayer

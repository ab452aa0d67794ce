// The separation guarantee. A voxel that is not interior differs from every voxel of the static
// surface by at least k (the offset layers) in some axis index, so that a point in it is at least
// (k - 1) s from the static mesh, and every point of the part's surface lies within the covering
// radius rho of a shell point. What is left of (k - 1) s after rho and after the deviations of
// scene, part and pose is proven.
//
// Where the guard goes by stored distances, it holds every shell point at a proven distance g from
// the mesh. Between two tested poses whose points travel a chord of at most s/2, the square of the
// distance falls by at most s^2/16, and the arc deviates from its chord before that. The larger of
// the two bounds counts.
#pragma once

#include <string>

#include "forcelayer/run.h"
#include "formats/surface_distance.h"

namespace forcelayer {

// The guard's distance g, guard_distance_m(), and what the shell proves from it. No distance
// where the guard goes by voxels alone.
struct DistanceGuard {
  double distance_m = 0;
  SurfaceDistanceTerms shell;
};

// `pose_error_m`: the rounding of a pose's arithmetic, ContactQuery::rounding_bound_m().
SeparationGuarantee separation_guarantee(const VoxmapHeader& voxmap, const PshellHeader& shell,
                                         double pose_error_m, const DistanceGuard& guard);

// An error where one of the two bounds does not exist, with the way to fix it. `part`: the shell's
// path, for the error. Errors: kFilesDoNotMatch.
Status require_guarantee(const VoxmapHeader& voxmap, const PshellHeader& shell, double pose_error_m,
                         const DistanceGuard& guard, const std::string& part);

}  // namespace forcelayer

// The separation guarantee. A voxel that is not interior differs from every voxel of the static
// surface by at least k (the offset layers) in some axis index, so that a point in it is at least
// (k - 1) s from the static mesh, and every point of the part's surface lies within the covering
// radius rho of a shell point. What is left of (k - 1) s after rho and after the deviations of
// scene, part and pose is proven.
#pragma once

#include <string>

#include "forcelayer/run.h"

namespace forcelayer {

// `pose_error_m`: the rounding of a pose's arithmetic, ContactQuery::rounding_bound_m().
SeparationGuarantee separation_guarantee(const VoxmapHeader& voxmap, const PshellHeader& shell,
                                         double pose_error_m);

// An error where one of the two bounds is none, with what would mend that. `part`: the shell's
// path, for the error. Errors: kFilesDoNotMatch.
Status require_guarantee(const VoxmapHeader& voxmap, const PshellHeader& shell, double pose_error_m,
                         const std::string& part);

}  // namespace forcelayer

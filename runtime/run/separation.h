// The separation guarantee (DESIGN 4): how far apart the exact surfaces are at every pose in which
// no shell point is in an interior voxel.
#pragma once

#include <optional>
#include <string>

#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"

namespace forcelayer {

struct SeparationGuarantee {
  std::optional<double> tested_m;  // at tested poses; none where the bound is not positive
  std::optional<double> swept_m;   // between two poses whose points travel at most s/2
};

// `pose_error_m` is e_pose, of ContactQuery::rounding_bound_m().
SeparationGuarantee separation_guarantee(const VoxmapHeader& voxmap, const PshellHeader& shell,
                                         double pose_error_m);

// "0.67 mm at every frame, 0.51 mm between frames ...", or "none ..."; rounded down.
std::string guarantee_text(const SeparationGuarantee& guarantee);

// Who does not say otherwise runs nothing without both bounds. `part`: the shell's path, and
// `otherwise` how that is said, both for the error. Errors: kFilesDoNotMatch.
Status require_guarantee(const SeparationGuarantee& guarantee, const std::string& part,
                         const char* otherwise);

}  // namespace forcelayer

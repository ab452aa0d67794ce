// --report picture: the worst moment of a path, drawn by voxview.
#pragma once

#include "formats/result.h"
#include "runtime/clearance/center_path.h"
#include "runtime/voxcheck/report.h"

namespace forcelayer::voxcheck {

// The worst violation, or else the moment where the path is nearest: part and object in colors of
// their own and named, the distance between them with its value. With the meshes of --exact where
// they were given, else with voxels and points. Errors: those of starting voxview.
Status draw_picture(const Report& report, const command::Verdict& verdict);

}  // namespace forcelayer::voxcheck

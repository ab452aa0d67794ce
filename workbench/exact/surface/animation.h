// The motion of a part through its scene as a file for viewers.
#pragma once

#include <string>
#include <vector>

#include "formats/path/path_file.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"
#include "runtime/voxcheck/exact_exchange.h"
#include "workbench/exact/surface/surfaces.h"

namespace forcelayer::exact {

// Writes the file that the request names: the part, then the objects of the scene from the nearest
// to the path to the farthest. The animation's times are those of the rows, s, counted from the
// first one. Rows that change the position of no point by more than a micrometer are left out.
// Objects that are too many triangles are left out, with a warning. Errors: those of write_glb().
Status write_animation(const voxcheck::ExactRequest& request, const Surface& scene,
                       const Voxmap& voxmap, const Surface& part, const Pshell& shell,
                       const std::vector<PathRow>& rows, std::vector<std::string>& warnings);

}  // namespace forcelayer::exact

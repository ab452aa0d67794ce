// Faces that the baked files lack, which no verdict covers.
#pragma once

#include <cstdint>
#include <string>

#include "formats/pshell.h"
#include "formats/voxmap.h"

namespace forcelayer::voxcheck {

std::uint64_t missing_faces(const Voxmap& scene, const Pshell& part);

// A warning for each file that lacks some.
void warn_of_missing_faces(const std::string& scene_path, const Voxmap& scene,
                           const std::string& part_path, const Pshell& part, bool quiet);

}  // namespace forcelayer::voxcheck

// What a user should know about a scene's meshes, a line each.
#pragma once

#include <string>
#include <vector>

#include "formats/mesh/scene.h"
#include "voxelize/bake.h"

namespace forcelayer {

// The scene's own warnings, and those that depend on the voxel size: 32-bit vertices that are
// coarser than a thousandth of a voxel where they lie.
std::vector<std::string> all_warnings(const Scene& scene, const BakeOptions& options);

}  // namespace forcelayer

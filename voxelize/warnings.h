// Warnings about a scene's meshes, a line each.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "formats/mesh/scene.h"
#include "voxelize/bake.h"
#include "voxelize/cache/mesh_source.h"

namespace forcelayer::voxelize {

// The scene's own warnings, and those that depend on the voxel size: 32-bit vertices that are
// coarser than a thousandth of a voxel where they lie. `meshes` are those of the objects.
std::vector<std::string> all_warnings(const mesh::Scene& scene,
                                      std::span<const cache::MeshOutline> meshes,
                                      const BakeOptions& options);

}  // namespace forcelayer::voxelize

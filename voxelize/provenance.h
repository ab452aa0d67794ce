// The provenance of a bake, JSON in the file: content hashes and the options that affect voxels.
#pragma once

#include <span>
#include <string>

#include "formats/mesh/scene.h"
#include "voxelize/bake.h"
#include "voxelize/cache/mesh_source.h"

namespace forcelayer::voxelize {

// The text depends on meshes, poses, object names and options, not on file names or threads.
// `meshes` are those of the objects.
std::string provenance_of(const mesh::Scene& scene, std::span<const cache::MeshOutline> meshes,
                          const BakeOptions& options);

}  // namespace forcelayer::voxelize

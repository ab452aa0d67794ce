// Where a bake comes from, as JSON in the file: content hashes and the options that affect voxels.
#pragma once

#include <span>
#include <string>

#include "formats/mesh/scene.h"
#include "voxelize/bake.h"
#include "voxelize/cache/mesh_source.h"

namespace forcelayer {

// Same meshes, poses and options give the same text, whatever the files are called and however
// many threads run. `meshes` are those of the parts.
std::string provenance_of(const Scene& scene, std::span<const MeshOutline> meshes,
                          const BakeOptions& options);

}  // namespace forcelayer

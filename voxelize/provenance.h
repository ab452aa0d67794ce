// Where a bake comes from, as JSON in the file: content hashes and the options that affect voxels.
#pragma once

#include <string>

#include "formats/mesh/scene.h"
#include "voxelize/bake.h"

namespace forcelayer {

// Same meshes, poses and options give the same text, whatever the files are called and however
// many threads run.
std::string provenance_of(const Scene& scene, const BakeOptions& options);

}  // namespace forcelayer

// Answers what voxcheck asks of the meshes: once, or path by path for a search.
#pragma once

#include <string>
#include <vector>

#include "formats/path/path_file.h"
#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"
#include "runtime/voxcheck/exact_exchange.h"
#include "workbench/exact/surface/surfaces.h"

namespace forcelayer::exact {

// Baked files and the meshes that they were baked from.
struct Meshes {
  Voxmap voxmap;
  Pshell shell;
  Surface scene, part;  // the scene in the world, the part about its centroid
  std::vector<std::string> warnings;
};

// Reads what a request names, but its path. Errors: those of reading files and meshes;
// kFilesDoNotMatch where the files were baked from other meshes.
Result<Meshes> read_meshes(const voxcheck::ExactRequest& request, bool quiet);

// Answers for a path of poses of the part, in place of the request's file. Errors:
// kFilesDoNotMatch.
Result<voxcheck::ExactAnswer> check_exactly(const Meshes& meshes, const std::vector<PathRow>& rows,
                                            const voxcheck::ExactRequest& request);

// Reads all that the request names, and answers. Errors: those of both, and of reading a path.
Result<voxcheck::ExactAnswer> check_exactly(const voxcheck::ExactRequest& request);

}  // namespace forcelayer::exact

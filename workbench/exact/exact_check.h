// Settles with the meshes the stretches of a path on which the baked files prove too little.
#pragma once

#include "formats/result.h"
#include "runtime/voxcheck/exact_exchange.h"

namespace forcelayer::exact {

// Reads all files and measures. Errors: those of the readers; kFilesDoNotMatch where the meshes are
// not those of the baked files.
Result<voxcheck::ExactAnswer> check_exactly(const voxcheck::ExactRequest& request);

}  // namespace forcelayer::exact

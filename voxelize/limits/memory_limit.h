// The machine's limits, checked before a bake takes any memory.
#pragma once

#include <string>

#include "formats/result.h"
#include "voxelize/scan/snap.h"

namespace forcelayer::limits {

// The most bytes that this process can have: memory and swap, or its own limit where that is less.
double available_bytes();

// Error kBakeTooLarge, with the numbers and a voxel size that might do, where the voxels of the
// largest triangle alone take more than `available` bytes. It catches a stray vertex, which makes
// slivers that are millions of voxels long. A scene that passes may still be too large.
Status fit_memory(const scan::SnappedObject& object, const std::string& name, double voxel_size_m,
                  double available);

}  // namespace forcelayer::limits

// The machine's limits, checked before a bake takes any memory.
#pragma once

#include <string>

#include "formats/result.h"
#include "voxelize/scan/snap.h"

namespace forcelayer {

// Bytes that this process can have at all: memory and swap, or less by its own limit.
double available_bytes();

// kBakeTooLarge, with the numbers and a voxel size that might do, where the largest triangle alone
// passes through so many voxels that marking them takes more than `available` bytes. A triangle
// passes through as many voxels as its projection along an axis covers, and as it is long along
// one, at least: a stray vertex gives slivers thinner than a voxel that are millions long. What
// fits by this may still be too large.
Status fit_memory(const SnappedObject& object, const std::string& name, double voxel_size_m,
                  double available);

}  // namespace forcelayer

// The clearance of uniform free entries: the Chebyshev distance from an entry's box to the nearest
// non-free voxel, exact up to the format's limit.
#pragma once

#include "voxelize/tree/built_tree.h"

namespace forcelayer::tree {

// Sets the clearance of every free entry, on all three levels. Every brick and every node in the
// tree must hold a voxel that is not free.
void add_clearance(BuiltTree& tree);

}  // namespace forcelayer::tree

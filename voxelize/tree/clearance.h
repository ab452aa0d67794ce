// The clearance of uniform free entries: the Chebyshev distance from an entry's box to the nearest
// non-free voxel, exact up to the format's limit.
#pragma once

#include "voxelize/tree/built_tree.h"

namespace forcelayer {

// Fills in the clearance of every free entry, on all three levels. Entries must be uniform wherever
// they can be: every brick and every node that stands in the tree holds a voxel that is not free.
void add_clearance(BuiltTree& tree);

}  // namespace forcelayer

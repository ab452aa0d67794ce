// A node's rows of values cut into the bricks of the 512-tree.
#pragma once

#include "voxelize/masks/dilation.h"
#include "voxelize/tree/built_tree.h"

namespace forcelayer {

// Entries, bricks and their nearness; a uniform brick becomes a uniform entry without clearance.
BuiltNode cut_into_bricks(const NodeCodes& codes);

}  // namespace forcelayer

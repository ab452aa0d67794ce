// One node's voxels cut into the bricks of the 512-tree.
#pragma once

#include "voxelize/distance/dilation.h"
#include "voxelize/distance/distance_codes.h"
#include "voxelize/tree/built_tree.h"

namespace forcelayer::tree {

// Entries, bricks and the bricks' gaps. A uniform brick becomes a uniform entry without clearance.
BuiltNode cut_into_bricks(const distance::NodeCodes& codes);

// The same for quantized distances; adds the node's voxels to `counts`. In the entries a uniform
// value of 0 stands for the free code and of 1 for code 0, so that they read as at two bits.
BuiltNode cut_into_bricks(const distance::NodeDistances& distances,
                          const distance::CodeScale& scale, distance::ValueCounts& counts);

}  // namespace forcelayer::tree

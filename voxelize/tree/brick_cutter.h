// One node's voxels cut into the bricks of the 512-tree.
#pragma once

#include "voxelize/distance/dilation.h"
#include "voxelize/distance/distance_codes.h"
#include "voxelize/tree/built_tree.h"

namespace forcelayer::tree {

// Entries, bricks and the bricks' gaps. A uniform brick becomes a uniform entry without clearance.
BuiltNode cut_into_bricks(const distance::NodeCodes& codes);

// The same for codes of distances, in bricks of kDistanceBrickParts, without gaps.
inline constexpr std::uint32_t kDistanceBrickParts = 4;
BuiltNode cut_into_bricks(const distance::NodeDistances& distances);

// And for numbers of objects, in bricks of kObjectBrickParts.
inline constexpr std::uint32_t kObjectBrickParts = 8;
BuiltNode cut_into_bricks(const distance::NodeObjects& objects);

}  // namespace forcelayer::tree

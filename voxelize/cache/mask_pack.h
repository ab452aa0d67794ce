// Mask trees as bytes: what a cache keeps of a part's voxels.
#pragma once

#include <memory>

#include "voxelize/cache/byte_pack.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/scan/snap.h"

namespace forcelayer {

// Appends the voxels of `tree`, whose voxels are counted from `origin` (a multiple of 512, world).
void pack(const MaskTree& tree, const VoxelIndex& origin, BytePacker& packer);

// Reads them back, counted from another `origin`. BadPack where there are voxels in a block that
// `box` (world) does not touch, or the bytes are no tree.
std::unique_ptr<MaskTree> unpack(ByteUnpacker& unpacker, const VoxelIndex& origin,
                                 const VoxelBox& box);

}  // namespace forcelayer

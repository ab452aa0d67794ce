// Mask trees as bytes, as a cache keeps an object's voxels.
#pragma once

#include <memory>

#include "voxelize/cache/byte_pack.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/masks/voxel_box.h"

namespace forcelayer::cache {

// Appends the voxels of `tree`, whose voxels are counted from `origin` (a multiple of 512, world).
void pack(const masks::MaskTree& tree, const lattice::VoxelIndex& origin, BytePacker& packer);

// Reads them back, counted from another `origin`. Throws BadPack where the bytes are no tree, or
// hold voxels in a directory cell that `box` (world) does not touch.
std::unique_ptr<masks::MaskTree> unpack(ByteUnpacker& unpacker, const lattice::VoxelIndex& origin,
                                        const masks::VoxelBox& box);

}  // namespace forcelayer::cache

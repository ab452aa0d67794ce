// Digests of all that a finished 64^3 node of the tree depends on.
#pragma once

#include <vector>

#include "voxelize/cache/digest.h"
#include "voxelize/distance/offset.h"

namespace forcelayer {

// For each of offset.nodes(), `origins`: the digest of what decides its voxels and the clearance of
// its bricks: layers, G and I in the 5^3 nodes around it. Wherever it lies. Nothing may be cropped.
std::vector<Digest> node_keys(const LayerOffset& offset, const std::vector<Coord>& origins);

}  // namespace forcelayer

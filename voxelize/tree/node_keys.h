// The key of a finished 64^3 node: a digest of everything that it depends on.
#pragma once

#include <vector>

#include "voxelize/cache/digest.h"
#include "voxelize/distance/layer_offset.h"

namespace forcelayer::tree {

// The keys of the nodes at `origins` (all of offset.nodes()): the layers, and G and I in the 5^3
// nodes around each, which decide its voxels and the clearance of its entries. The key of a node
// does not depend on where it lies. Nothing may be cropped.
std::vector<cache::Digest> node_keys(const distance::LayerOffset& offset,
                                     const std::vector<masks::Coord>& origins);

}  // namespace forcelayer::tree

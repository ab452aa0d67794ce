// The force layer (paper 4.2): the surface offset outward by layers, node by node.
#pragma once

#include <vector>

#include "voxelize/dilation.h"
#include "voxelize/mask_tree.h"

namespace forcelayer {

// With c(v) the Chebyshev distance from v to the nearest voxel of `geometry`, a voxel outside
// `interior` becomes interior where c <= k-1, surface where c = k, proximity where c = k+1, else it
// is free. The trees must outlive the object; codes() may run on many threads.
class LayerOffset {
 public:
  // `box` holds every voxel that the offset does not leave free.
  LayerOffset(const MaskTree& geometry, const MaskTree& interior, unsigned layers,
              const openvdb::CoordBBox& box);

  // Origins of the nodes of the box that can hold a voxel within k+1 of the geometry, sorted by x,
  // y, z. All others are uniform: interior where an active tile of `interior` covers them, else
  // free.
  std::vector<Coord> nodes() const;

  // The values of the node at `origin`; `halo` is scratch space that may be used again.
  ValueCounts codes(const Coord& origin, NodeHalo& halo, NodeCodes& codes) const;

 private:
  const MaskTree& geometry_;
  const MaskTree& interior_;
  int layers_;
  openvdb::CoordBBox box_;
};

}  // namespace forcelayer

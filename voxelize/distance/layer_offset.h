// The force layer (paper 4.2): the surface offset outward by layers, node by node.
#pragma once

#include <vector>

#include "voxelize/distance/dilation.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/masks/voxel_box.h"

namespace forcelayer {

// With c(v) the Chebyshev distance from v to the nearest voxel of `geometry`, a voxel outside
// `interior` becomes interior where c <= k-1, surface where c = k, proximity where c = k+1, else it
// is free. The trees must outlive the object; codes() may run on many threads.
class LayerOffset {
 public:
  // Voxels outside `kept` are free.
  LayerOffset(const MaskTree& geometry, const MaskTree& interior, unsigned layers,
              const KeptBox& kept);

  // Origins, ascending, of the nodes that can hold a voxel within k+1 of the geometry and of those
  // that a cropped side cuts inside a solid. Every other node is uniform: interior where an active
  // tile of `interior` covers it and it is kept, else free.
  std::vector<Coord> nodes() const;

  const MaskTree& geometry() const { return geometry_; }
  const MaskTree& interior() const { return interior_; }
  int layers() const { return layers_; }
  const KeptBox& kept() const { return kept_; }

  // The values of the node at `origin`. `halo` is scratch space.
  ValueCounts codes(const Coord& origin, NodeHalo& halo, NodeCodes& codes) const;

 private:
  void add_cut_solids(std::vector<Coord>& origins) const;

  const MaskTree& geometry_;
  const MaskTree& interior_;
  int layers_;
  KeptBox kept_;
};

}  // namespace forcelayer

// The force layer (paper 4.2): the surface offset outward by layers, node by node.
#pragma once

#include <vector>

#include "voxelize/distance/dilation.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/masks/voxel_box.h"

namespace forcelayer::distance {

// With c(v) the Chebyshev distance from v to the nearest voxel of `geometry`, k `layers` and n
// `force_layers`, a voxel outside `interior` becomes interior where c <= k-1, surface where it is
// up to k-1+n, proximity where c = k+n, else it is free (paper 4.2, where n is 1). The trees must
// outlive the object; codes() may run on many threads.
class LayerOffset {
 public:
  // Voxels outside `kept` are free.
  LayerOffset(const masks::MaskTree& geometry, const masks::MaskTree& interior, unsigned layers,
              unsigned force_layers, const masks::KeptBox& kept);

  // Origins, ascending, of the nodes that can hold a voxel within k+n of the geometry and of those
  // that a cropped side cuts inside a solid. Every other node is uniform: interior where an active
  // tile of `interior` covers it and it is kept, else free.
  std::vector<masks::Coord> nodes() const;

  const masks::MaskTree& geometry() const { return geometry_; }
  const masks::MaskTree& interior() const { return interior_; }
  int layers() const { return layers_; }
  int force_layers() const { return force_layers_; }
  const masks::KeptBox& kept() const { return kept_; }

  // The values of the node at `origin`. `halo` is scratch space.
  ValueCounts codes(const masks::Coord& origin, NodeHalo& halo, NodeCodes& codes) const;

 private:
  void add_cut_solids(std::vector<masks::Coord>& origins) const;

  const masks::MaskTree& geometry_;
  const masks::MaskTree& interior_;
  int layers_, force_layers_;
  masks::KeptBox kept_;
};

}  // namespace forcelayer::distance

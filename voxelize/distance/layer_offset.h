// The force layer (paper 4.2): the surface offset outward by layers, node by node.
#pragma once

#include <vector>

#include "voxelize/distance/dilation.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/masks/voxel_box.h"

namespace forcelayer::distance {

// Let c(v) be the Chebyshev distance from voxel v to the nearest voxel of `geometry`, k the number
// of layers and n that of force layers. A voxel outside `interior` becomes interior where c <= k-1,
// surface where k <= c <= k-1+n, proximity where c = k+n, and else is free (paper 4.2, where n is
// 1). The trees must outlive this; codes() may run on many threads.
class LayerOffset {
 public:
  // Voxels outside `kept` are free.
  LayerOffset(const masks::MaskTree& geometry, const masks::MaskTree& interior, unsigned layers,
              unsigned force_layers, const masks::KeptBox& kept);

  // The origins, ascending, of the nodes whose values must be computed: those that can hold a voxel
  // within k+n of the geometry, and those in which a cropped side cuts a solid. Every other node is
  // uniform: interior where it is kept and an active tile of `interior` covers it, else free.
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

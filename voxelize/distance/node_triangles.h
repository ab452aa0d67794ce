// The triangles that come near a 64^3-voxel node.
#pragma once

#include <cstdint>
#include <vector>

#include "voxelize/distance/near_triangle.h"
#include "voxelize/scan/node_bins.h"

namespace forcelayer {

// The triangles of some objects, by the nodes that they come near to.
class SceneTriangles {
 public:
  // Nearer than `reach` voxels (1..64). The objects must outlive this.
  SceneTriangles(std::vector<const SnappedObject*> objects, int reach);

  // In ascending order.
  const std::vector<NodeIndex>& nodes() const { return nodes_; }

  // Those that come near `node`, in lattice units from its lowest corner; empty for one that is not
  // in nodes(). Triangles that reach far beyond are cut to what lies near, so that single precision
  // can hold them.
  void gather(const NodeIndex& node, std::vector<NearTriangle>& near) const;

 private:
  struct Bin {
    std::uint32_t object, bin;
  };

  // Triangles listed for nodes_[n].
  std::size_t count_near(std::size_t n) const;

  std::vector<const SnappedObject*> objects_;
  int reach_;
  std::vector<NodeBins> bins_;      // [objects]
  std::vector<NodeIndex> nodes_;    // [n]
  std::vector<std::size_t> first_;  // [n + 1] offsets into of_node_
  std::vector<Bin> of_node_;
  std::size_t most_near_ = 0;  // the most that count_near() gives
};

}  // namespace forcelayer

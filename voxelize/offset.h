// The force layer (paper 4.2): the surface offset outward by layers, node by node.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "voxelize/mask_tree.h"

namespace forcelayer {

// The two-bit values of a 64^3 node as rows along z: value = low + 2 high, [x*64 + y], bit z.
struct NodeCodes {
  std::array<std::uint64_t, 4096> low, high;
};

// Voxels of a node by value.
struct ValueCounts {
  std::uint64_t interior = 0, surface = 0, proximity = 0;

  ValueCounts& operator+=(const ValueCounts& other) {
    interior += other.interior;
    surface += other.surface;
    proximity += other.proximity;
    return *this;
  }
};

// With c(v) the Chebyshev distance from v to the nearest voxel of `geometry`, a voxel outside
// `interior` becomes interior where c <= k-1, surface where c = k, proximity where c = k+1, else it
// is free. The trees must outlive the object; codes() may run on many threads, each with its own
// Scratch.
class LayerOffset {
 public:
  struct Scratch {
    std::vector<std::uint64_t> below, here, above;  // rows of the node and of its halo
    std::vector<std::uint64_t> along_z, along_y;    // dilated, per radius
    std::vector<char> occupied;                     // planes of constant x that hold anything
  };

  // `box` holds every voxel that the offset does not leave free.
  LayerOffset(const MaskTree& geometry, const MaskTree& interior, unsigned layers,
              const openvdb::CoordBBox& box);

  // Origins of the nodes of the box that can hold a voxel within k+1 of the geometry, sorted by x,
  // y, z. All others are uniform: interior where an active tile of `interior` covers them, else
  // free.
  std::vector<Coord> nodes() const;

  ValueCounts codes(const Coord& node_origin, Scratch& scratch, NodeCodes& codes) const;

 private:
  const MaskTree& geometry_;
  const MaskTree& interior_;
  int layers_;
  openvdb::CoordBBox box_;
};

}  // namespace forcelayer

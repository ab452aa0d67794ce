// A voxmap's layers in cells of several voxels: fewer faces, for pictures that have to be quick.
#pragma once

#include <array>
#include <cstdint>
#include <unordered_map>

#include "workbench/viewer/surface/quad_surface.h"

namespace forcelayer::viewer {

// A cell is in the force layer where one of its voxels is, else interior where one is, else
// proximity where one is. Cells are aligned with the lattice.
class CoarseLayers {
 public:
  static constexpr int kLargestEdge = 8;

  // `edge_voxels` of a cell: 2, 4 or 8. `voxmap` must outlive the layers.
  CoarseLayers(const Voxmap& voxmap, int edge_voxels);

  // As layer_surface(), of cells.
  QuadSurface surface(VoxelValue layer, const glm::dvec3& origin_m) const;

 private:
  using Block = std::array<VoxelValue, 512>;  // 8x8x8 cells
  struct Layer;

  VoxelValue value(const RelativeVoxel& cell) const;
  VoxelValue value_of_voxels(const RelativeVoxel& cell) const;
  void add_block(const RelativeVoxel& low_voxel);

  const Voxmap& voxmap_;
  int edge_;
  std::unordered_map<std::uint64_t, Block> blocks_;  // those that are not uniform boxes
};

}  // namespace forcelayer::viewer

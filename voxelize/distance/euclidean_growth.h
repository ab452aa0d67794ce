// The Euclidean growth of a surface: the interior that Euclidean layers add around the surface.
#pragma once

#include <memory>

#include "voxelize/distance/triangle_search.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/scan/snap.h"

namespace forcelayer::distance {

inline constexpr std::uint32_t kMaxBakedLayers = 30;

// The radius of growth, in lattice units: a voxel becomes interior where its center is nearer than
// this to the surface. It is half a voxel's diagonal and a little, plus k - 1 voxels for k `layers`
// (voxmap_format.md, section 10).
inline constexpr std::int64_t kMinInteriorUnits = 888;
constexpr std::int64_t interior_radius_units(int layers) {
  return (layers - 1) * lattice::kSnapUnits + kMinInteriorUnits;
}

// The voxels outside `interior` whose centers are less than `radius_units` from the object's
// surface. They include every voxel that the surface passes through. The radius is from
// kMinInteriorUnits to interior_radius_units(kMaxBakedLayers). Voxels count from `scene_origin`.
// Exact: the kernels decide where their error allows it, center_is_nearer() elsewhere.
std::unique_ptr<masks::MaskTree> grow_surface(const scan::SnappedObject& object,
                                              const masks::MaskTree& interior,
                                              std::int64_t radius_units,
                                              const lattice::VoxelIndex& scene_origin);

// Which voxels of a cell have centers less than a radius from a surface. The kernels decide where
// their error allows it, center_is_nearer() elsewhere.
class CenterGrowth {
 public:
  // The triangles must outlive this.
  CenterGrowth(const SceneTriangles& triangles, std::int64_t radius_units);

  // near() needs exact distances up to this one, in voxels.
  float reach() const { return reach_; }

  // The near voxels among the voxels `open` of the cell at voxel `low` of a node. `smallest` holds
  // the cell's squared distances, `list` every triangle that may be nearest to one of these voxels.
  std::uint64_t near(const CubeValues& smallest, std::uint64_t open, TriangleList list,
                     const scan::NodeIndex& node, const std::array<int, 3>& low) const;

 private:
  bool is_near(TriangleList list, const lattice::VoxelIndex& voxel) const;

  const SceneTriangles& triangles_;
  std::int64_t radius_units_;
  float reach_;
  CubeValues surely_near_, maybe_near_;  // squared lattice units, the same for every voxel
};

// Whether the center of `voxel` is less than `radius_units` lattice units (1 to 2^15) from
// `triangle`, in exact integer arithmetic.
bool center_is_nearer(const lattice::LatticeTriangle& triangle, const lattice::VoxelIndex& voxel,
                      std::int64_t radius_units);

}  // namespace forcelayer::distance

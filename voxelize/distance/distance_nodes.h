// Voxels of 4 and 8 bits: quantised distances from the offset surface, node by node.
#pragma once

#include <memory>
#include <vector>

#include "voxelize/distance/distance_scale.h"
#include "voxelize/distance/node_triangles.h"
#include "voxelize/masks/dilation.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/tree/built_tree.h"
#include "voxelize/tree/kept_box.h"

namespace forcelayer {

class DistanceScratch;

// The trees and objects must outlive the object; node() may run on many threads. All distances are
// from the surfaces of `objects`, negative in `interior`, and in voxels of `geometry` whose centre
// lies on the interior's side of the surface.
class DistanceNodes {
 public:
  // What lies outside `kept` is free.
  DistanceNodes(std::vector<const SnappedObject*> objects, const VoxelIndex& scene_origin,
                const MaskTree& geometry, const MaskTree& interior, const DistanceScale& scale,
                const KeptBox& kept);
  ~DistanceNodes();

  // How many voxels around the geometry may have a code of their own.
  static int reach(const DistanceScale& scale);

  const DistanceScale& scale() const { return scale_; }

  // The 64^3 node at `origin`, counted from the scene's. In its entries a uniform value of 0 stands
  // for the free code and one of 1 for code 0, so that they read as at two bits.
  BuiltNode node(const Coord& origin, ValueCounts& counts) const;

 private:
  VoxelIndex scene_origin_;
  const MaskTree& geometry_;
  const MaskTree& interior_;
  DistanceScale scale_;
  KeptBox kept_;
  SceneTriangles triangles_;
  std::unique_ptr<DistanceScratch> scratch_;
};

}  // namespace forcelayer

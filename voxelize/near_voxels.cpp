#include "voxelize/near_voxels.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include "voxelize/brick_bits.h"
#include "voxelize/cell_search.h"
#include "voxelize/cube_distance.h"
#include "voxelize/node_rows.h"
#include "voxelize/node_triangles.h"

namespace forcelayer {
namespace {

// From the middle of a cube to its corners, voxels, rounded up.
constexpr float kHalfDiagonal = 0.8661f;

// One 64^3 node at a time.
class NearNode {
 public:
  std::unique_ptr<LowerMaskNode> run(const SceneTriangles& triangles, const NodeIndex& node,
                                     const Coord& origin, const MaskTree& geometry,
                                     const MaskTree& interior, int radius) {
    node_rows(geometry, origin, near_);
    node_rows(interior, origin, settled_);
    for (std::size_t i = 0; i < settled_.size(); ++i) settled_[i] |= near_[i];
    triangles.gather(node, triangles_);
    for (NearTriangle& triangle : triangles_.near) add_features(triangle);
    const float reach = static_cast<float>(radius) + kHalfDiagonal;
    search_.run(
        triangles_.near, false,
        [&](const std::array<int, 3>& low, int edge) {
          return all_set(settled_, low, edge) ? kNothingMatters : reach;
        },
        [&](const std::array<int, 3>& low, NearList list) {
          unsure_.resize(list.size());
          std::uint64_t open = ~cell_bits(settled_, low);
          std::uint64_t bits = open & cubes_near(list, CellSearch::centers(low, 1),
                                                 static_cast<float>(radius), unsure_.data());
          open &= ~bits;
          for (std::size_t i = 0; i < list.size() && open != 0; ++i) {
            const std::uint64_t found = decided(unsure_[i] & open, *list[i], node, low, radius);
            bits |= found;
            open &= ~found;
          }
          add_cell_bits(bits, low, near_);
        });
    return node_of_rows(near_, origin);
  }

 private:
  // Those of a cell's voxels to which the triangle does come near.
  std::uint64_t decided(std::uint64_t voxels, const NearTriangle& triangle, const NodeIndex& node,
                        const std::array<int, 3>& low, int radius) const {
    std::uint64_t near = 0;
    for (; voxels != 0; voxels &= voxels - 1) {
      const int n = std::countr_zero(voxels);
      const VoxelIndex voxel{node[0] * 64 + low[0] + (n >> 4), node[1] * 64 + low[1] + (n >> 2 & 3),
                             node[2] * 64 + low[2] + (n & 3)};
      if (comes_nearer(triangles_.whole[triangle.source], voxel, radius)) {
        near |= std::uint64_t{1} << n;
      }
    }
    return near;
  }

  NodeRows near_, settled_;
  NodeTriangles triangles_;
  CellSearch search_;
  std::vector<std::uint64_t> unsure_;
};

}  // namespace

std::unique_ptr<MaskTree> near_voxels(const SnappedObject& object, const MaskTree& geometry,
                                      const MaskTree& interior, int radius_voxels,
                                      const VoxelIndex& scene_origin) {
  const SceneTriangles triangles({&object}, radius_voxels);
  std::vector<std::unique_ptr<LowerMaskNode>> nodes(triangles.nodes().size());
  tbb::enumerable_thread_specific<NearNode> scratch;
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
    const NodeIndex& node = triangles.nodes()[i];
    const Coord origin(static_cast<int>(node[0] * 64 - scene_origin[0]),
                       static_cast<int>(node[1] * 64 - scene_origin[1]),
                       static_cast<int>(node[2] * 64 - scene_origin[2]));
    nodes[i] = scratch.local().run(triangles, node, origin, geometry, interior, radius_voxels);
  });
  auto tree = std::make_unique<MaskTree>();
  for (auto& node : nodes) {
    if (node->getChildMask().isOff()) continue;
    add_node(*tree, std::move(node));
  }
  return tree;
}

}  // namespace forcelayer

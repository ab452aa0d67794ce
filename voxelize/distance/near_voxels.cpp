#include "voxelize/distance/near_voxels.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

#include "voxelize/distance/cell_search.h"
#include "voxelize/distance/center_distance.h"
#include "voxelize/distance/node_triangles.h"
#include "voxelize/masks/brick_bits.h"
#include "voxelize/masks/node_rows.h"

namespace forcelayer {
namespace {

// One 64^3 node at a time.
class NearNode {
 public:
  // `triangles` are those of `object` alone.
  std::unique_ptr<LowerMaskNode> run(const SnappedObject& object, const SceneTriangles& triangles,
                                     const NodeIndex& node, const Coord& origin,
                                     const MaskTree& interior, std::int64_t radius_units) {
    object_ = &object;
    node_rows(interior, origin, settled_);
    near_ = {};
    triangles.gather(node, triangles_);
    constexpr auto kUnits = static_cast<float>(kSnapUnits);
    const float radius = static_cast<float>(radius_units) / kUnits;
    const float reach = radius + kDistanceErrorVoxels;
    surely_near_ = square((radius - kDistanceErrorVoxels) * kUnits);
    maybe_near_ = square(reach * kUnits);
    search_.run(
        triangles_,
        [&](const std::array<int, 3>& low, int edge) {
          return all_set(settled_, low, edge) ? kNothingMatters : reach;
        },
        [&](const std::array<int, 3>& low, NearList list) {
          mark_pair(low, list, reach * kUnits, node, radius_units);
        });
    return node_of_rows(near_, origin);
  }

 private:
  static float square(float x) { return x * x; }

  // Two cells of 4^3 voxels, the second behind the first along z.
  void mark_pair(const std::array<int, 3>& low, NearList list, float reach_units,
                 const NodeIndex& node, std::int64_t radius_units) {
    std::array<std::array<int, 3>, 2> lows{low, low};
    lows[1][2] += 4;
    std::array<float, 2 * kEighths> reach;
    std::array<std::uint64_t, 2> open;
    for (std::size_t cell = 0; cell < 2; ++cell) {
      open[cell] = ~cell_bits(settled_, lows[cell]);
      for (unsigned n = 0; n < kEighths; ++n) {
        reach[cell * kEighths + n] = (open[cell] & eighth(n)) != 0 ? reach_units : kNothingMatters;
      }
    }
    nearest_.find(list, CellSearch::centers(low, 1), reach);
    for (std::size_t cell = 0; cell < 2; ++cell) {
      const CubeValues& least = nearest_.least(cell);
      std::uint64_t near = 0, unsure = 0;
      for (std::size_t n = 0; n < kCubePoints; ++n) {
        near |= std::uint64_t{least[n] < surely_near_} << n;
        unsure |= std::uint64_t{least[n] <= maybe_near_} << n;
      }
      unsure &= open[cell] & ~near;
      near &= open[cell];
      for (; unsure != 0; unsure &= unsure - 1) {
        const int n = std::countr_zero(unsure);
        if (is_near(list, lows[cell], n, node, radius_units)) near |= std::uint64_t{1} << n;
      }
      add_cell_bits(near, lows[cell], near_);
    }
  }

  // Whether one of the triangles is near to voxel n of a cell.
  bool is_near(NearList list, const std::array<int, 3>& low, int n, const NodeIndex& node,
               std::int64_t radius_units) const {
    const VoxelIndex voxel{node[0] * 64 + low[0] + (n >> 4), node[1] * 64 + low[1] + (n >> 2 & 3),
                           node[2] * 64 + low[2] + (n & 3)};
    return std::any_of(list.begin(), list.end(), [&](const NearTriangle* triangle) {
      return center_is_nearer(object_->triangle(triangle->source), voxel, radius_units);
    });
  }

  NodeRows near_, settled_;
  const SnappedObject* object_ = nullptr;
  std::vector<NearTriangle> triangles_;
  CellSearch search_;
  NearestTriangles nearest_;
  float surely_near_ = 0, maybe_near_ = 0;  // squared lattice units
};

}  // namespace

std::unique_ptr<MaskTree> near_voxels(const SnappedObject& object, const MaskTree& interior,
                                      int layers, const VoxelIndex& scene_origin) {
  const std::int64_t radius_units = interior_radius_units(layers);
  const SceneTriangles triangles({&object}, layers);  // the radius is below that many voxels
  std::vector<std::unique_ptr<LowerMaskNode>> nodes(triangles.nodes().size());
  tbb::enumerable_thread_specific<NearNode> scratch;
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
    const NodeIndex& node = triangles.nodes()[i];
    const Coord origin(static_cast<int>(node[0] * 64 - scene_origin[0]),
                       static_cast<int>(node[1] * 64 - scene_origin[1]),
                       static_cast<int>(node[2] * 64 - scene_origin[2]));
    nodes[i] = scratch.local().run(object, triangles, node, origin, interior, radius_units);
  });
  auto tree = std::make_unique<MaskTree>();
  for (auto& node : nodes) {
    if (node->getChildMask().isOff()) continue;
    add_node(*tree, std::move(node));
  }
  return tree;
}

}  // namespace forcelayer

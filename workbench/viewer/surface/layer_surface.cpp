#include "workbench/viewer/surface/layer_surface.h"

#include <algorithm>

namespace forcelayer::viewer {
namespace {

struct Layer {
  const ShownVoxels& voxels;
  VoxelValue value;

  bool contains(const RelativeVoxel& v) const { return voxels.value(v) == value; }
  bool borders(const RelativeVoxel& v) const { return lies_further_out(voxels.value(v), value); }
};

}  // namespace

bool lies_further_out(VoxelValue a, VoxelValue b) {
  constexpr std::array<int, 4> kRank = {3, 0, 1, 2};  // free, interior, surface, proximity
  return kRank[static_cast<unsigned>(a)] > kRank[static_cast<unsigned>(b)];
}

QuadSurface layer_surface(const Voxmap& voxmap, VoxelValue layer, const glm::dvec3& origin_m,
                          Faces faces, const HiddenObjects& hidden) {
  const VoxmapView& view = voxmap.view();
  QuadWriter writer(view.directory_origin, voxmap.voxel_size_m(), origin_m, faces);
  const ShownVoxels shown(voxmap, hidden);
  const Layer set{shown, layer};
  FaceFinder<Layer> finder(set, writer);
  const auto brick = [&](const RelativeVoxel& low) { finder.brick(low); };
  walk_tree(
      view,
      [&](const RelativeVoxel& low, std::int32_t edge, std::uint32_t code) {
        if (static_cast<VoxelValue>(code) != layer) return;
        if (!shown.hides()) {
          finder.uniform_box(low, edge);
        } else {
          shown.known_bricks(low, edge, brick);
        }
      },
      brick);
  return writer.take();
}

QuadSurface slice_surface(const Voxmap& voxmap, VoxelValue layer, int axis, std::int64_t index,
                          int side, const glm::dvec3& origin_m, const HiddenObjects& hidden) {
  const VoxmapView& view = voxmap.view();
  QuadWriter writer(view.directory_origin, voxmap.voxel_size_m(), origin_m, Faces::kMerged);
  const ShownVoxels shown(voxmap, hidden);
  const Layer set{shown, layer};
  const std::int64_t relative = index - view.directory_origin[static_cast<std::size_t>(axis)];
  if (relative < 0 || relative >= std::int64_t{512} * view.directory_dims[axis]) {
    return writer.take();
  }
  const auto level = static_cast<std::int32_t>(relative);
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  // A box that the cut misses holds nothing; one that it meets shows tiles of 8x8 voxels.
  const auto tiles = [&](const RelativeVoxel& low, std::int32_t edge, bool whole) {
    if (level < low[axis] || level >= low[axis] + edge) return;
    RelativeVoxel tile = low;
    tile[axis] = level;
    for (tile[u] = low[u]; tile[u] < low[u] + edge; tile[u] += 8) {
      for (tile[v] = low[v]; tile[v] < low[v] + edge; tile[v] += 8) {
        std::uint64_t mask = whole ? ~std::uint64_t{0} : 0;
        for (int bit = 0; bit < 64 && !whole; ++bit) {
          RelativeVoxel voxel = tile;
          voxel[u] += bit & 7;
          voxel[v] += bit >> 3;
          if (set.contains(voxel)) mask |= std::uint64_t{1} << bit;
        }
        writer.add(tile, axis, side, mask);
      }
    }
  };
  walk_tree(
      view,
      [&](const RelativeVoxel& low, std::int32_t edge, std::uint32_t code) {
        if (static_cast<VoxelValue>(code) == layer) tiles(low, edge, !shown.hides());
      },
      [&](const RelativeVoxel& low) { tiles(low, kBrickEdge, false); });
  return writer.take();
}

}  // namespace forcelayer::viewer

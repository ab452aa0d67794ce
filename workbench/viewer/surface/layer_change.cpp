#include "workbench/viewer/surface/layer_change.h"

#include <algorithm>
#include <string>

namespace forcelayer::viewer {
namespace {

// Voxels of `value` in `map` but not in `other`. Voxels are relative to `map`.
struct Difference {
  const Voxmap& map;
  const Voxmap& other;
  VoxelValue value;

  VoxelValue other_value(const RelativeVoxel& v) const {
    const auto& origin = map.view().directory_origin;
    return other.value(origin[0] + v[0], origin[1] + v[1], origin[2] + v[2]);
  }
  bool contains(const RelativeVoxel& v) const {
    return relative_value(map, v) == value && other_value(v) != value;
  }
  bool borders(const RelativeVoxel& v) const { return !contains(v); }
};

struct Comparison {
  std::uint64_t only = 0, both = 0;  // voxels of the value in the one map, and in both
  QuadSurface surface;
};

Comparison difference(const Voxmap& map, const Voxmap& other, VoxelValue value,
                      const glm::dvec3& origin_m) {
  QuadWriter writer(map.view().directory_origin, map.voxel_size_m(), origin_m, Faces::kMerged);
  const Difference set{map, other, value};
  FaceFinder<Difference> finder(set, writer);
  Comparison result;
  const auto brick = [&](const RelativeVoxel& low) {
    std::uint64_t only = 0;
    for (int n = 0; n < 512; ++n) {
      const RelativeVoxel v = {low[0] + (n >> 6), low[1] + ((n >> 3) & 7), low[2] + (n & 7)};
      if (relative_value(map, v) != value) continue;
      const bool shared = set.other_value(v) == value;
      (shared ? result.both : only) += 1;
    }
    result.only += only;
    if (only > 0) finder.brick(low);
  };
  const auto box = [&](const RelativeVoxel& low, std::int32_t edge, std::uint32_t code) {
    if (static_cast<VoxelValue>(code) != value) return;
    for (std::int32_t x = 0; x < edge; x += 8) {
      for (std::int32_t y = 0; y < edge; y += 8) {
        for (std::int32_t z = 0; z < edge; z += 8) brick({low[0] + x, low[1] + y, low[2] + z});
      }
    }
  };
  walk_tree(map.view(), box, brick);
  result.surface = writer.take();
  return result;
}

}  // namespace

Result<LayerChange> layer_change(const Voxmap& before, const Voxmap& after, VoxelValue layer,
                                 const glm::dvec3& origin_m) {
  if (before.voxel_size_m() != after.voxel_size_m()) {
    return Error{ErrorCode::kFilesDoNotMatch, "", "",
                 "the voxel sizes differ: " + std::to_string(before.voxel_size_m()) + " m and " +
                     std::to_string(after.voxel_size_m()) + " m",
                 "bake both scenes with the same --voxel-size"};
  }
  Comparison added = difference(after, before, layer, origin_m);
  Comparison removed = difference(before, after, layer, origin_m);
  return LayerChange{added.only, removed.only, added.both, std::move(added.surface),
                     std::move(removed.surface)};
}

}  // namespace forcelayer::viewer

// The voxels of a map without those of objects that are hidden.
#pragma once

#include <vector>

#include "workbench/viewer/surface/quad_surface.h"

namespace forcelayer::viewer {

// [number of an object in the file] Whether it is hidden; the first entry, for voxels of which no
// object is known, as deep in a solid, is true. Empty: nothing is hidden.
using HiddenObjects = std::vector<char>;

class ShownVoxels {
 public:
  // Both must outlive this. Nothing is hidden in a map that does not tell objects apart.
  ShownVoxels(const Voxmap& voxmap, const HiddenObjects& hidden)
      : voxmap_(voxmap), hidden_(hidden), hides_(!hidden.empty() && voxmap.objects() != nullptr) {}

  bool hides() const { return hides_; }

  // Free where the object is hidden.
  VoxelValue value(const RelativeVoxel& v) const {
    const VoxelValue value = relative_value(voxmap_, v);
    return hides_ && value != VoxelValue::kFree && hidden_[object_of(v)] != 0 ? VoxelValue::kFree
                                                                              : value;
  }

  // Calls brick(low) for the 8^3 boxes of a uniform box in which an object may be known.
  template <typename Brick>
  void known_bricks(const RelativeVoxel& low, std::int32_t edge, const Brick& brick) const {
    const VoxelLookup code = code_of(low);
    if (static_cast<std::int32_t>(code.edge_voxels) >= edge && !is_measured(code.code)) return;
    if (edge == static_cast<std::int32_t>(kBrickEdge)) {
      brick(low);
      return;
    }
    const std::int32_t part = edge / 8;
    for (std::int32_t n = 0; n < 512; ++n) {
      known_bricks(
          {low[0] + (n >> 6) * part, low[1] + (n >> 3 & 7) * part, low[2] + (n & 7) * part}, part,
          brick);
    }
  }

 private:
  static bool is_measured(std::uint32_t code) { return code > 0 && code < kMaxDistanceCode; }

  // Looks a voxel up in the tree of distances. A map without distances answers as if measured.
  VoxelLookup code_of(const RelativeVoxel& v) const {
    const DistanceView* distances = voxmap_.distances();
    if (distances == nullptr) return {1, 0, 1};
    RelativeVoxel at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      at[axis] = static_cast<std::int32_t>(v[axis] + voxmap_.view().directory_origin[axis] -
                                           distances->directory_origin[axis]);
    }
    return distances->contains(at[0], at[1], at[2]) ? distances->lookup(at[0], at[1], at[2])
                                                    : VoxelLookup{kMaxDistanceCode, 0, 512};
  }

  // 0 where none is known, or the number is a hint.
  std::uint32_t object_of(const RelativeVoxel& v) const {
    if (!is_measured(code_of(v).code)) return 0;
    const auto& origin = voxmap_.view().directory_origin;
    return voxmap_.nearest_object(origin[0] + v[0], origin[1] + v[1], origin[2] + v[2]);
  }

  const Voxmap& voxmap_;
  const HiddenObjects& hidden_;
  bool hides_;
};

}  // namespace forcelayer::viewer

// The tangent-plane force model (paper 3): the plane through the voxel's centre whose normal is the
// point's own.
#pragma once

#include "runtime/field/force_field.h"

namespace forcelayer {

// Depth d = n . (c - p) along the point's inward normal n, c the voxel's centre. A point in value 1
// lies behind the force layer: it gets half a voxel, the field's nominal depth.
//
// Where voxels store distances, the plane lies as far behind the centre as the voxel's own distance
// says (nearest voxel and tangent plane), in value 1 too.
class TangentPlaneField final : public ForceField {
 public:
  explicit TangentPlaneField(const Voxmap& voxmap);
  explicit TangentPlaneField(double voxel_size_m)  // of any map of two bits
      : voxel_size_m_(static_cast<float>(voxel_size_m)) {}

  // In front of the plane a point's depth is negative; at two bits a point in value 3 has a whole
  // layer to go.
  void measure(const CollectedPoints& points, FieldSamples& samples) const noexcept override;

 private:
  float depth_voxels(const CollectedPoints& points, std::uint32_t i) const noexcept;

  float voxel_size_m_;
  const VoxmapView* distances_ = nullptr;  // null at two bits
  float zero_code_ = 0, voxels_per_code_ = 0;
};

}  // namespace forcelayer

// The tangent-plane force model (paper 3): the plane through the voxel's center whose normal is the
// point's own.
#pragma once

#include "runtime/field/force_field.h"

namespace forcelayer::field {

// Depth d = n . (c - p) along the point's inward normal n, c the voxel's center. A point in value 1
// lies behind the force layer: it gets half a voxel, the field's nominal depth.
//
// Where voxels store distances, the plane lies as far behind the voxel's center as the stored
// distance says, in value 1 too.
class TangentPlaneField final : public ForceField {
 public:
  explicit TangentPlaneField(const Voxmap& voxmap);
  explicit TangentPlaneField(double voxel_size_m)  // of any map of two bits
      : voxel_size_m_(static_cast<float>(voxel_size_m)) {}

  // A point in front of the plane has a negative depth. At two bits a point in value 3 lies a whole
  // layer further out.
  void measure(const query::CollectedPoints& points, FieldSamples& samples) const noexcept override;

 private:
  float depth_voxels(const query::CollectedPoints& points, std::uint32_t i) const noexcept;

  float voxel_size_m_;
  const VoxmapView* distances_ = nullptr;  // null at two bits
  float zero_code_ = 0, voxels_per_code_ = 0;
};

}  // namespace forcelayer::field

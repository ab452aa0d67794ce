// The tangent-plane force model (paper 3): the plane through the voxel's centre whose normal is the
// point's own.
#pragma once

#include "runtime/force_field.h"

namespace forcelayer {

// Depth d = max(0, n . (c - p)) along the point's inward normal n, c the voxel's centre. A point in
// value 1 lies behind the force layer: it gets half a voxel, the field's nominal depth.
class TangentPlaneField final : public ForceField {
 public:
  explicit TangentPlaneField(double voxel_size_m)
      : voxel_size_m_(static_cast<float>(voxel_size_m)) {}

  void evaluate(const CollectedPoints& points, FieldSamples& samples) const noexcept override;

  // In front of the plane a point's depth is negative; a point in value 3 has a whole layer to go.
  void measure(const CollectedPoints& points, FieldSamples& samples) const noexcept override;

 private:
  float voxel_size_m_;
};

}  // namespace forcelayer

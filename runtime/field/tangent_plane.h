// The tangent-plane force model (paper 3): the plane through the voxel's center whose normal is the
// point's own.
#pragma once

#include "runtime/field/force_field.h"

namespace forcelayer::field {

// Depth d = n . (c - p) along the point's inward normal n, c the voxel's center. A point in value 1
// lies behind the force layer: it gets half a voxel, the field's nominal depth.
class TangentPlaneField final : public ForceField {
 public:
  explicit TangentPlaneField(double voxel_size_m)
      : voxel_size_m_(static_cast<float>(voxel_size_m)) {}

  // A point in front of the plane has a negative depth. A point in value 3 lies a whole layer
  // further out.
  void measure(const query::CollectedPoints& points, FieldSamples& samples) const noexcept override;

 private:
  float voxel_size_m_;
};

}  // namespace forcelayer::field

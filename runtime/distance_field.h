// The force field of voxels that store a distance (4 and 8 bits; formats/voxmap_format.md, 6).
//
// phi, in voxels, is the stored distance from the zero-force surface, interpolated trilinearly
// between the eight voxel centres around a point, and g its slope there, per voxel. In front of a
// smooth wall both are those of the exact distance but for the quantum and the wall's curvature, so
// that the direction is the slope's and no normal has to help out. phi is continuous, and negative
// only in voxels of values 1 and 2 (voxmap_format.md, 6).
//
// Push. With n the point's inward normal:
//   u = g + 0.05 b n, along d = u/|u|
//   depth = s min(1, 10 |u|) (min(e, 1) + max(0, e - 1) min(1, 10 |g|)), e = max(0, -phi)
//   b: 0 for a depth up to 1.5 voxels, 1 from 2 on.
// Halfway between two walls g vanishes, and the push with it. Deep inside, where all codes are 0,
// it is half a voxel along the normal, as the tangent plane gives; where distances are stored, it
// leads to the nearest way out.
#pragma once

#include <optional>

#include "formats/result.h"
#include "runtime/distance_bricks.h"
#include "runtime/distance_push.h"
#include "runtime/force_field.h"

namespace forcelayer {

class DistanceField final : public ForceField {
 public:
  // Why the map stores no distances, if so. A kUsage error.
  static std::optional<Error> unreadable(const Voxmap& voxmap);

  // The map must be readable and outlive the field. Takes 10 MB for decoded bricks.
  explicit DistanceField(const Voxmap& voxmap);

  // As ForceField says; by one thread at a time.
  void evaluate(const CollectedPoints& points, FieldSamples& samples) const noexcept override;
  void measure(const CollectedPoints& points, FieldSamples& samples) const noexcept override;
  bool has_exact_slopes() const noexcept override { return true; }

 private:
  DistanceCodes codes_;
  mutable DistanceBricks bricks_;  // a memo: no answer depends on it
};

}  // namespace forcelayer

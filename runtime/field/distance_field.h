// The force field of voxels that store a distance (4 and 8 bits; formats/voxmap_format.md, 6).
//
// phi, in voxels, is the stored distance from the zero-force surface, interpolated trilinearly
// between the eight voxel centres around a point. g is its slope there, per voxel: along each axis
// the difference of neighbouring codes, taken to be that of the middle between their centres, and
// interpolated between such middles along the axis and between centres across it. So g is
// continuous, where the gradient of phi jumps from cell to cell; it reads the eight codes of phi's
// cell and four more beside it along each axis, on the side where the point's voxel is.
// In front of a smooth wall phi and g are those of the exact distance but for the quantum and the
// wall's curvature, so that the direction is g's and no normal has to help out. phi is continuous,
// and negative only in voxels of values 1 and 2 (voxmap_format.md, 6).
//
// Where codes end. Where phi < 0 at 8 bits, none of the voxels that g reads is free, whose codes
// say no more than that: D changes by at most the distance between two points, and a voxel that g
// reads is at most sqrt(5/2 + 1 + 1) = 2.12 voxels, in the weighted mean, from the eight centres
// whose codes make phi, but free ones lie 2.85 and more in front of the zero-force surface. At 4
// bits codes end within the proximity. Inside, g is short of the true slope within 2.12 voxels of
// where code 0 begins. Cropped sides and the map's own are read as phi reads them: as the nearest
// known voxel, and free.
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
#include "runtime/field/distance_bricks.h"
#include "runtime/field/distance_push.h"
#include "runtime/field/force_field.h"

namespace forcelayer {

class DistanceField final : public ForceField {
 public:
  // Why the map stores no distances, if so. A kUsage error.
  static std::optional<Error> unreadable(const Voxmap& voxmap);

  // The map must be readable and outlive the field. Takes 13 MB for decoded bricks.
  explicit DistanceField(const Voxmap& voxmap);

  // As ForceField says; by one thread at a time.
  void measure(const CollectedPoints& points, FieldSamples& samples) const noexcept override;
  bool has_exact_slopes() const noexcept override { return true; }

 private:
  DistanceCodes codes_;
  mutable DistanceBricks bricks_;  // a memo: no answer depends on it
};

}  // namespace forcelayer

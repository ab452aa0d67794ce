// A continuous force field from the two-bit values (DESIGN 6, "a truer field").
//
// Levels. A voxel's value is a level: interior -1, surface 0, proximity 1, free 2. With k >= 1
// offset layers the levels are the Chebyshev distance in voxels from the layer k, cut off at both
// ends, so 26-neighbours differ by at most one.
//
// phi. At each corner of the voxel lattice stand the mean of the eight levels around it and, along
// each axis, the mean difference of the four pairs across it. Inside a voxel all four are
// interpolated trilinearly between its eight corners: phi in voxels, and a slope per axis. That
// reads the 27 voxels around a point, with the trapezoid (box of 1 * box of 2 voxels) as kernel.
//   - phi and the slope are continuous; along an axis they change by at most 1 and 2 per voxel.
//   - phi < 0 needs a voxel of level -1 among the 27, so the point's own voxel has level -1 or 0:
//     only points in values 1 and 2 are pushed, as in the paper; guard and guarantee stay the same.
//   - On a plane of any orientation the layers are |n|_1 s apart along its unit normal n. The
//     trapezoid's transform vanishes at the frequency of these steps where n lies along an axis
//     or a face diagonal (sinc(f) sinc(2 f) at f = 1 and 1/2) and is 0.04 along a space diagonal,
//     so phi falls almost evenly with the depth: by 1 over |n|_1 s. The quadratic B-spline over the
//     same 27 voxels has 0.18 there, trilinear interpolation over 8 voxels 0.32.
//
// Push. With n the point's inward normal, g the slope, both along which a point may be pushed:
//   v = f (w n + (1 - w) g/|g|) + (1 - f) h n/2,  depth = s |v|_1 max(0, -phi) along v/|v|
//   w: 1 where the cosine of n and g is at least 0.9, 0 where it is at most 0.7, smooth between
//   f = min(1, |g| / 0.1): where g vanishes it has no direction. No plane, edge or corner has so
//       small a slope in the force layer; the middle of a narrow gap has, and the deep interior,
//   h: 0 for phi >= -1/2, 1 for phi <= -3/4: in the interior, where all 27 voxels agree and only
//      the normal is left, a point gets half a voxel along it, as the tangent plane gives.
// |v|_1 turns the Chebyshev distance into a Euclidean one in front of a plane (in maps of Euclidean
// layers it is |v|). The push is continuous in position and normal. It is not the gradient of a
// potential: who needs passivity must see to it himself.
//
// Normal or slope? Measured by force_bench (tests/bench/METHOD.md):
//   - On flush and smooth contacts the normal is right, and g alone is off by 1 to 2 degrees with
//     five times the torque error; g is an estimate from 27 small integers, the normal is exact.
//   - At edges and corners of the part the normals of the faces are wrong (17 degrees against 8 at
//     a box's corner on a plane) and g is right. On a thin sheet's far side n points into the wall:
//     there the paper's force attracts; along g it cannot, since in front of a plane every
//     component of g has the sign of the plane's normal.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "formats/result.h"
#include "runtime/force_field.h"

namespace forcelayer {

class LevelField final : public ForceField {
 public:
  // Why the map's values are no levels, if so: it has no offset layers (k = 0: values jump from
  // interior to proximity), or more than two bits. A kUsage error.
  static std::optional<Error> unreadable(const Voxmap& voxmap);

  // The map must be readable and outlive the field.
  explicit LevelField(const Voxmap& voxmap);

  void evaluate(const CollectedPoints& points, FieldSamples& samples) const noexcept override;
  void measure(const CollectedPoints& points, FieldSamples& samples) const noexcept override;

 private:
  struct Measured {
    float depth_m;  // signed
    std::array<float, 3> direction;
  };
  Measured measured(const CollectedPoints& points, std::uint32_t i) const noexcept;
  int level(std::int64_t x, std::int64_t y, std::int64_t z) const noexcept;

  VoxmapView map_;
  float voxel_size_m_;
  bool euclidean_layers_;
  // Box of the voxels that are known, relative to the directory; unbounded where nothing was cut.
  std::array<std::int64_t, 3> known_min_{}, known_max_{};  // inclusive, exclusive
};

}  // namespace forcelayer

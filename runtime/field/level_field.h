// A continuous force field from the two-bit values (DESIGN 6, "a truer field").
//
// Levels. A voxel's value is a level: interior -1, surface 0, proximity 1, free 2. With k >= 1
// offset layers the levels are the Chebyshev distance in voxels from the layer k, cut off at both
// ends, so 26-neighbours differ by at most one.
//
// phi. At each corner of the voxel lattice stand the mean of the eight levels around it and, along
// each axis, the mean difference of the four pairs across it. Inside a voxel all four are
// interpolated trilinearly between its eight corners: phi in voxels, and a slope per axis (along x
// and y in 16 bits, which moves phi by less than 2^-12 voxel). That reads the 27 voxels around a
// point, with the trapezoid (box of 1 * box of 2 voxels) as kernel.
//   - phi and the slope are continuous; along an axis they change by at most 1 and 2 per voxel.
//   - phi < 0 needs a voxel of level -1 among the 27, so the point's own voxel has level -1 or 0.
//   - On a plane of any orientation the layers are |n|_1 s apart along its unit normal n. The
//     trapezoid's transform vanishes at the frequency of these steps where n lies along an axis
//     or a face diagonal (sinc(f) sinc(2 f) at f = 1 and 1/2) and is 0.04 along a space diagonal,
//     so phi falls almost evenly with the depth: by 1 over |n|_1 s. The quadratic B-spline over the
//     same 27 voxels has 0.18 there, trilinear interpolation over 8 voxels 0.32.
//
// Push. With n the point's inward normal and g the slope:
//   u = (w + 0.05 h) n + (1 - w) g
//   depth = s max(0, a - (phi + b) |d|_1) min(1, 10 |u|) along d = u/|u|
//   a, b: 0 with Chebyshev layers, sqrt(3)/2 and 1/2 with Euclidean ones.
//   w: 1 where n and g agree, 0 where they do not: smoothstep of 16 (q |q| - 9/16 |g|^2) with
//      q = n . g. It begins at a cosine of 3/4 and ends at 0.8 to 0.95, the closer to 1 the less g
//      is sure.
//   h: 0 for phi >= -1/2, 1 for phi <= -3/4. Deep inside, where all 27 voxels agree, g vanishes:
//      a point gets about half a voxel along its normal, as the tangent plane gives.
// |d|_1 turns the Chebyshev distance into a Euclidean one in front of a plane; the layers of
// Euclidean maps too are one voxel deep in all 26 directions. Where g vanishes halfway between two
// walls, the push fades to nothing. The push is continuous in position and normal. It is not the
// gradient of a potential: who needs passivity must see to it himself.
//
// Where the push begins.
//   - Chebyshev layers (a = b = 0): at phi = 0, which is k |n|_1 s off a plane. Only points in
//     values 1 and 2 are pushed, as in the paper.
//   - Euclidean layers end the interior, phi = -1/2, at the same distance R from every plane
//     on average (voxmap_format.md, section 5). The push begins sqrt(3)/2 s before that, at the
//     same distance too; phi is 0 to 0.37 there. It may reach into value 3, where phi is 1/8 or
//     more, but less than a quarter of a voxel deep: in tunnels, grooves and pits whose force
//     layers leave one voxel between them, and at the lattice's steps in walls almost along the
//     grid. In free voxels phi is 9/8 or more. It could hardly begin nearer: in an interior voxel,
//     whose 26 neighbours are interior or surface, phi is at most -1/8, and just enough is left of
//     the depth, (sqrt(3)/2 - 3/8 |d|_1) s where the push has its whole strength, to hold a point
//     back from a corner of the interior.
// Values, guard and guarantee know nothing of this.
//
// Normal or slope? Measured by force_bench at 5 mm (tests/bench/force.md), medians:
//   - Flush and smooth contacts: force along g alone is off by 2.3 degrees and 0.028 in torque,
//   this
//     blend by 0.8 degrees and 0.006. g is an estimate from 27 small integers, the normal is exact.
//   - A box's corner on a plane: normals alone 13 degrees, this blend 10, g alone 6: the faces'
//     normals are wrong there. Wedges, an offset per wall: this blend 0.2-6 degrees, g 2-4, normals
//     of the uncorrected levels 0.1-23.
//   - On a thin sheet's far side n points into the wall: there the paper's force attracts; along g
//     it cannot, since in front of a plane every component of g has the sign of the plane's normal.
//   - At 50 mm/s the force changes by at most 0.1% from frame to frame, the paper's by 12%.
// So a model may take the direction as it comes; it need not choose one itself.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "formats/result.h"
#include "runtime/field/force_field.h"
#include "runtime/field/level_bricks.h"
#include "runtime/field/level_push.h"

namespace forcelayer {

class LevelField final : public ForceField {
 public:
  // Why the map's values are no levels, if so: it has no offset layers (k = 0: values jump from
  // interior to proximity), or more than two bits. A kUsage error.
  static std::optional<Error> unreadable(const Voxmap& voxmap);

  // The map must be readable and outlive the field. Takes 4 MB for decoded bricks.
  explicit LevelField(const Voxmap& voxmap);

  // As ForceField says; by one thread at a time.
  void evaluate(const CollectedPoints& points, FieldSamples& samples) const noexcept override;
  void measure(const CollectedPoints& points, FieldSamples& samples) const noexcept override;

 private:
  LevelScale scale_;
  mutable LevelBricks bricks_;  // a memo: no answer depends on it
};

}  // namespace forcelayer

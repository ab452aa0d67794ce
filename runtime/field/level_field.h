// The level field: depth and direction from the two-bit values of the 27 voxels around a point.
//
// Levels. Each value is a level: interior -1, surface 0, proximity 1, free 2. With k >= 1 offset
// layers a level is the Chebyshev distance in voxels from layer k, cut off at both ends, so the
// levels of 26-neighbors differ by at most one.
//
// phi and g. At each corner of the voxel lattice stand the mean of the eight levels around it and,
// per axis, the mean difference of the four pairs across it. Inside a voxel these four numbers are
// interpolated trilinearly between its eight corners. The first is phi, in voxels; the others are
// its slope g, per voxel. The weights along x and y have 16 bits, which moves phi by less than
// 2^-12 voxel. Each axis thus has the trapezoid (a box of 1 * a box of 2 voxels) as its kernel.
//   - phi and g are continuous. Along an axis phi changes by at most 1 per voxel, g by at most 2.
//   - phi < 0 needs a level of -1 among the 27, so the point's own voxel has level -1 or 0.
//   - Behind a plane with the unit normal n the layers are |n|_1 s apart, and phi falls by 1 over
//     that distance. It falls almost evenly, because the kernel damps the layers' steps: to nothing
//     where n lies along an axis or a face diagonal (sinc(f) sinc(2 f) at f = 1 and 1/2), and along
//     a space diagonal to this fraction:
//         trapezoid, 27 voxels          0.04
//         quadratic B-spline, 27        0.18
//         trilinear, 8                  0.32
//
// Push. With n the point's inward normal:
//   u = (w + 0.05 h) n + (1 - w) g
//   depth = s (a - (phi + b) |d|_1) min(1, 10 |u|) along d = u/|u|
//   a, b: 0 with Chebyshev layers, sqrt(3)/2 and 1/2 with Euclidean ones.
//   w: 1 where n and g agree, 0 where they do not: smoothstep of 16 (q |q| - 9/16 |g|^2) with
//      q = n . g. It begins at a cosine of 3/4 and ends at 0.8 to 0.95; the shorter g is, the
//      later.
//   h: 0 for phi >= -1/2, 1 for phi <= -3/4. Deep inside all 27 voxels agree and g vanishes: there
//      a point gets about half a voxel along its normal, as the tangent plane gives.
// The factor |d|_1 turns the Chebyshev distance into a Euclidean one in front of a plane; Euclidean
// layers too are one voxel deep in all 26 directions. Halfway between two walls g vanishes and the
// push fades to nothing. Where u has no direction, the direction is n and the depth -phi in front
// of the layer, 0 behind. The push is continuous in position and normal, but it is not the gradient
// of a potential: a model must see to passivity itself.
//
// Where the push begins.
//   - Chebyshev layers: at phi = 0, which is k |n|_1 s off a plane. Only points in values 1 and 2
//     are pushed, as in the paper.
//   - Euclidean layers: the interior ends, at phi = -1/2, on average at one distance from every
//     plane (formats/voxmap_format.md, section 5). The push begins sqrt(3)/2 s before that, where
//     phi is 0 to 0.37. In value 3, where phi is at least 1/8, the push is less than a quarter of a
//     voxel deep; this happens in tunnels, grooves and pits whose force layers leave one voxel
//     between them, and at the lattice's steps in walls that run almost along the grid. Free voxels
//     have phi >= 9/8 and no push. The push could not begin much nearer: at a corner of the
//     interior phi may be -1/8, and the depth left there, (sqrt(3)/2 - 3/8 |d|_1) s, must still
//     hold a point back.
//
// Why a blend. Median errors at 5 mm, on contacts with a closed formula:
//                                        along g     this push   along n
//     flush and smooth, direction        2.3 deg     0.8 deg
//     flush and smooth, torque           0.028       0.006
//     a box's corner on a plane          6 deg       10 deg      13 deg
//     wedges, an offset per wall         2-4 deg     0.2-6 deg   0.1-23 deg
// g is an estimate from 27 small integers; n is exact, but at an edge it is the wrong face's. On
// the far side of a thin sheet n points into the wall, where the paper's force attracts. A push
// along g cannot attract: in front of a plane each component of g has the sign of the normal's.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "formats/result.h"
#include "runtime/field/brick_cache.h"
#include "runtime/field/force_field.h"

namespace forcelayer::field {

// Bricks decoded with one voxel of halo. A decoded brick holds 10 planes (x) of 8 rows (y) of 10
// bytes (z). Each byte holds three voxels along y: those at y-1, y and y+1 in bits 0, 2 and 4, as
// raised levels (one more than the level, so that none is negative). y runs over the brick's own
// voxels, x and z over the halo too. The 27 levels around voxel (x, y, z) of the brick are bytes z
// to z+2 of row y in planes x to x+2; byte z+3, which is read along with them, is in the row too.
class LevelBricks : public BrickCache {
 public:
  static constexpr std::uint32_t kRowBytes = 12;
  static constexpr std::uint32_t kPlaneBytes = 8 * kRowBytes;
  static constexpr std::uint32_t kBrickBytes = 10 * kPlaneBytes;

  // The map has two bits per voxel and outlives this.
  explicit LevelBricks(const Voxmap& voxmap);

  // Per slot kBrickBytes of raised levels.
  const std::uint8_t* levels() const { return levels_.data(); }

  // The levels of the brick of voxels 8 b to 8 b + 7, relative to the map's directory_origin and
  // inside its directory; decoded into the brick's slot unless it is there already.
  const std::uint8_t* hold_brick(std::int32_t bx, std::int32_t by, std::int32_t bz) noexcept;

 private:
  const std::uint8_t* values_of(const BrickIndex& brick) const noexcept;
  void decode(const BrickIndex& brick, std::uint8_t* levels) const noexcept;
  void decode_voxelwise(const BrickIndex& brick, std::uint8_t* levels) const noexcept;

  VoxmapView map_;
  std::vector<std::uint8_t> levels_;
};

// The constants of the push that depend on the map.
struct LevelScale {
  float voxel_size_m = 0;
  float a = 0;
  float b = 0;
};

class LevelField final : public ForceField {
 public:
  // Why the field cannot read the map, if so: it has no offset layers (k = 0: values jump from
  // interior to proximity), or more than two bits per voxel. A kUsage error.
  static std::optional<Error> unreadable(const Voxmap& voxmap);

  // The map must be readable and outlive the field. Takes 4 MB for decoded bricks.
  explicit LevelField(const Voxmap& voxmap);

  // As ForceField says; by one thread at a time. In level_field_kernel.cpp.
  void measure(const query::CollectedPoints& points, FieldSamples& samples) const noexcept override;

 private:
  LevelScale scale_;
  mutable LevelBricks bricks_;  // no answer depends on which bricks are there
};

}  // namespace forcelayer::field

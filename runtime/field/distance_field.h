// The distance field: depth and direction from stored distances (formats/voxmap_format.md, section
// 6).
//
// phi is the stored distance from the zero-force surface, in voxels, interpolated trilinearly
// between the eight voxel centers around a point. It is continuous, and negative only in voxels
// that are not free (voxmap_format.md, section 6).
//
// g is the slope of phi, per voxel. Along an axis it is made of the differences of neighboring
// codes: each belongs to the middle between its two centers, and g is interpolated between such
// middles along the axis and between centers across it. So g is continuous, where the gradient of
// phi jumps from cell to cell. It reads the eight codes of phi's cell and four more beside it per
// axis, on the side where the point's voxel is. In front of a smooth wall phi and g are those of
// the exact distance but for the quantum and the wall's curvature, so the direction is g's and no
// normal has to help.
//
// Where codes end. All free voxels have the same code, whatever their distance. Where phi < 0 at 8
// bits, g reads no free voxel: the codes that g reads are at most sqrt(5/2 + 1 + 1) = 2.12 voxels,
// in the weighted mean, from the eight centers that make phi; free voxels lie 2.85 voxels and more
// in front of the zero-force surface; and D changes by at most the distance between two points. At
// 4 bits codes end within the proximity. Inside, g is too short within 2.12 voxels of the place
// where code 0 begins. A voxel beyond a cropped side has the code of the nearest known voxel; one
// outside the map is free. This holds for phi too.
//
// Push. With n the point's inward normal:
//   u = g + 0.05 b n, along d = u/|u|
//   depth = s min(1, 10 |u|) (min(e, 1) + max(0, e - 1) min(1, 10 |g|)), e = -phi
//   b: 0 for a depth up to 1.5 voxels, 1 from 2 on.
// Halfway between two walls g vanishes, and the push with it. Inside the scene the push leads to
// the nearest way out where codes still differ, and half a voxel along the normal where all are 0,
// as the tangent plane gives. Where u has no direction, the direction is n and the depth min(e, 0).
//
// Proven distance. The squared distance to a set, less |x|^2, is concave. So with D_i the lower
// bounds that the eight codes stand for, w_i their trilinear weights and t_a the point's place
// between the centers along axis a,
//   d^2 >= sum_i w_i max(D_i, 0)^2 - s^2 sum_a t_a (1 - t_a).
// A code of 0 has no lower bound and counts as 0, like all at or below the mesh. A point has
// no proven distance where one of the eight lies beyond a cropped side. Rounding comes off under
// the root.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "formats/bricks/unpacked_distances.h"
#include "formats/result.h"
#include "runtime/field/brick_cache.h"
#include "runtime/field/force_field.h"

namespace forcelayer::field {

// Bricks decoded with one voxel of halo. A cell lies between the centers of eight voxels. A decoded
// brick holds the codes at the corners of all cells that touch one of the brick's centers: 9 planes
// (x) of 9 rows (y) of 10 words (z) of four bytes, from the voxel before the brick on. Byte
// 2 x' + y' of word z is the code at (x + x', y + y', z). The codes at the corners of cell
// (x, y, z) are words z and z + 1 of row y of plane x; the codes beside the cell are a word, row or
// plane before or behind.
class DistanceBricks : public BrickCache {
 public:
  static constexpr std::uint32_t kRowBytes = 40;
  static constexpr std::uint32_t kPlaneBytes = 9 * kRowBytes;
  static constexpr std::uint32_t kBrickBytes = 9 * kPlaneBytes;
  // Offset of the cell between the brick's own first voxel and the seven behind it.
  static constexpr std::uint32_t kFirstBytes = kPlaneBytes + kRowBytes + 4;
  static constexpr std::uint32_t kMargin = 8;  // bytes that may be read beyond all bricks

  // The map stores distances and outlives this.
  explicit DistanceBricks(const Voxmap& voxmap);

  // Per slot kBrickBytes of codes.
  const std::uint8_t* codes() const { return codes_.data() + kMargin; }

  // The codes of the brick of voxels 8 b to 8 b + 7, relative to the map's directory_origin and
  // inside its directory; decoded into the brick's slot unless it is there already.
  const std::uint8_t* hold_brick(std::int32_t bx, std::int32_t by, std::int32_t bz) noexcept;

  // Codes along z, a byte each, from the one before the brick on.
  struct Row {
    std::uint64_t first;  // eight
    std::uint32_t last;   // two
  };

 private:
  // The brick and the voxels around it, [x][y].
  using Halo = std::array<std::array<Row, 10>, 10>;

  void gather(const BrickIndex& brick, Halo& halo) noexcept;
  void gather_voxelwise(const BrickIndex& brick, Halo& halo) noexcept;
  // Adds what the brick of an entry has in the halo: kPart 0, 1, 2 along z.
  template <int kPart, typename Part>
  void add_brick(std::uint32_t entry, const Part& in_x, const Part& in_y, Halo& halo) noexcept;

  DistanceView map_;
  UnpackedDistances unpacked_;
  std::vector<std::uint8_t> codes_;
};

// From codes to meters.
struct DistanceScale {
  float voxel_size_m = 0;
  float zero_code = 0;  // of the zero-force surface
  float voxels_per_code = 0;
  float mesh_code = 0;  // of distances from 0 to a step
  float squared_codes_per_voxel = 0;
};

class DistanceField final : public ForceField {
 public:
  // Why the map stores no distances, if so. A kUsage error.
  static std::optional<Error> unreadable(const Voxmap& voxmap);

  // The map must be readable and outlive the field. Takes 15 MB for decoded bricks.
  explicit DistanceField(const Voxmap& voxmap);

  // As ForceField says; by one thread at a time. In distance_field_kernel.cpp.
  void measure(const query::CollectedPoints& points, FieldSamples& samples) const noexcept override;
  bool has_exact_slopes() const noexcept override { return true; }
  bool proves_distances() const noexcept override { return true; }

 private:
  DistanceScale scale_;
  bool cropped_;
  mutable DistanceBricks bricks_;  // no answer depends on which bricks are there
};

}  // namespace forcelayer::field

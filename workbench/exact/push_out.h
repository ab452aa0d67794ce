// Whether a little shift takes a piece of surface out of a solid. It is how a depth is bounded
// where surfaces touch, slide along each other or overlap:
//
//   Let C be a convex set of places, and u a shift no longer than D. If C + u meets no triangle of
//   a closed solid, and one place of it is outside, then no place of C is deeper than D.
//
// For a place p of C that is deeper than D, all that is within D of p is inside of the solid, p + u
// too. But C + u is connected and meets no surface, so all of it is outside.
//
// The set may be the hull of a piece at two moments: then this holds for the whole motion between
// them. A flat face on a flat floor, a block in a corner and a plate that lifts off are settled as
// a whole by a shift along the floor's normal, however many triangles they have.
#pragma once

#include <array>
#include <cstddef>

#include "workbench/exact/body.h"

namespace forcelayer::exact {

// The convex hull of a piece of surface at one moment or at two.
struct Hull {
  explicit Hull(const part::Piece& piece);
  Hull(const part::Piece& from, const part::Piece& to);

  std::array<part::Vec3, 6> points;
  std::size_t count;                // of points
  std::array<part::Vec3, 4> edges;  // directions: of the piece's edges, and of its motion
  std::size_t edge_count;
  part::Vec3 center;
  double reach = 0;  // from the center to the farthest point
};

// How far the places of a motion leave the hull of its two ends. A body that turns about an axis of
// one direction, and goes straight otherwise, accelerates across that direction alone: a face that
// turns in its own plane stays in it.
struct Bend {
  double max_m = 0;
  part::Vec3 axis;  // a unit vector; zero: in any direction

  // The same along a direction of length 1. The axis of a turn by an angle a is rounded by some
  // 1e-16 / a, and a bend is at most proportional to a: the error is less than the rounding that
  // comes_free() adds.
  double along_m(const part::Vec3& direction) const {
    if (axis == part::Vec3{}) return max_m;
    return max_m * part::length(part::cross(direction, axis));
  }
};

// Whether a shifted hull and a triangle are farther apart than `min_m` along a direction, of any
// length, for all of a motion that leaves the hull by `bend`.
bool is_farther_along(const part::Vec3& along, const Hull& hull, const part::Piece& triangle,
                      const part::Vec3& shift, double min_m, const Bend& bend = {});

// Whether such a direction is found: of the normals of both, and those of their edges.
bool is_farther(const Hull& hull, const part::Piece& triangle, const part::Vec3& shift,
                double min_m, const Bend& bend = {});

// Whether all places of a motion are proven to stay outside of the solid.
bool stays_outside(const Body& solid, const Hull& hull, const Bend& bend = {});

// Whether a shift is found that is no longer than `max_m`, and that takes all places of a motion
// out of the solid. No says nothing.
bool comes_free(const Body& solid, const Hull& hull, double max_m, const Bend& bend = {});

// Whether all places of a motion that are no deeper than `depth_m` are on one side of the solid:
// no wall is so thin there that some of them are as near to one side of it as to the other. Faces
// of both sides may be near, which less depth may exclude; or the solid may be all about, which a
// smaller hull or more depth may exclude.
//
//   Let p be a place, and v a direction with n.v >= c > 0 for the normals n of all triangles within
//   (1 + 1 / c) D of p, and of those on the way from there to p + 2 v D / c. If that place is
//   outside, the places outside that are within D of p are connected outside.
//
// Along a way that leaves v by less than asin(c), triangles are only crossed with their normals: so
// the winding number never rises. From two places outside within D of p such ways lead to their
// middle, moved along v by D / c, and from there to p + 2 v D / c. It is 0 at both ends, and so all
// the way. Nothing of this depends on how the solid is turned: of an inside-out shell, that place
// lies inside.
//
// Through a crack, a way crosses no triangle. Where one is near, the same place on the other side
// of p must be inside: a sheet that is open all around has no inside.
enum class Sides { kOne, kBoth, kUnknown };
Sides sides_of(const Body& solid, const Hull& hull, double depth_m, const Bend& bend = {});

}  // namespace forcelayer::exact

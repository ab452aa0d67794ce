// How deep two bodies lie in each other: the deepest place of the surface of one of them inside of
// the other, by branch and bound.
//
// The signed depth of a place in a solid, s(p), is its distance from the solid's triangles, inside
// of them, and less than zero outside. It changes no faster than the place moves. So on a piece of
// surface about c, no place of which is farther from c than R,
//   s(p) <= s(c) + R         (from outside through a crack as wide as e: s(c) + R + e)
// And no place is deeper than it is far from any triangle T of the solid. That distance is convex:
//   s(p) <= the largest distance of the piece's corners from T
// which settles a piece that lies on T. And a piece that meets no triangle of a closed solid lies
// on one side of it:
//   s(p) <= 0                (outside)
// which settles a piece before a wall, however near. A piece that touches the surface from outside,
// or overlaps it by little, is settled by a shift (push_out.h). A piece that these do not settle is
// cut: along an edge of T, where that settles the one half; else in two.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>

#include "forcelayer/pose.h"
#include "workbench/exact/body.h"

namespace forcelayer::exact {

struct Depth {
  double found_m = -std::numeric_limits<double>::infinity();  // of the deepest place found
  double at_most_m = found_m;   // no place is deeper; negative: the surfaces are so far apart
  glm::dvec3 place_m{0};        // that place, world,
  glm::dvec3 foot_m{0};         // and the nearest of the other surface
  std::size_t pair = 0;         // of which it is a place
  std::uint64_t looked_at = 0;  // nodes and pieces, until it was found
  bool is_at_foot = false;      // of SeatWalk, whose places are the part's: the deepest is foot_m
};

// A surface, the solid that it may lie in, and where they are.
struct SurfaceInSolid {
  const Body* surface;
  const Body* solid;  // Body::is_solid()
  Pose world_from_surface, world_from_solid;
  const Parts* parts;  // of the surface, that count
};

// The surface without its places near its own cracks or those of a solid in the same frame: those
// within nine widths of a crack. Where such places are too many, some of them stay.
struct AwayFromCracks {
  Parts parts;
  bool is_all = true;  // no place in the box of the solid is near a crack
};
AwayFromCracks away_from_cracks(const Body& surface, const Body& solid);

using DepthProgress = std::function<void(double fraction)>;

// The deepest place of all pairs. `found_m` and `at_most_m` differ by `within_m` and the width of
// cracks at most, or by `within_fraction` of the depth. With `allowed_m` they also may differ by as
// much as they are both below it, and the search ends at the first place that is deeper than
// allowed: `at_most_m` is then any upper bound. The search begins with the
// place `known`. Where surfaces meet, that is one of depth 0: by cutting alone an edge that lies on
// a face is found only after millions of pieces.
Depth deepest(std::span<const SurfaceInSolid> pairs, std::optional<double> allowed_m,
              double within_m, double within_fraction = 0, const DepthProgress& progress = {},
              const Depth& known = {});

}  // namespace forcelayer::exact

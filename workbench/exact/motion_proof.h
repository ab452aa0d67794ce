// Whether a surface stays allowed while it moves: no place of it goes deeper into a solid than it
// may, between two poses as at them.
//
// A triangle of the surface that moves is a convex set in the solid's frame: the hull of its
// corners at both ends, but for the bend of their ways. push_out.h settles it where a shift takes
// it out of the solid, and the distance from a triangle does where it lies on that (depth.h). What
// neither settles is cut.
//
// Between two walls no depth is more than half of the thinner one. So a place that is allowed to be
// as deep as that may leave a wall on its other side. A motion keeps its side where each piece of
// it is proven to be no deeper than D, for a D of its own, and the solid has one side within reach
// of that (push_out.h). The places outside that are within D of one of its places are then
// connected outside, those of a piece beside it are among them, or they are among those: what is
// within the smaller D is within the larger. So the surface can be followed by one outside that
// moves as continuously and nowhere goes farther from it than that reach. It passes through no
// wall: where it changes from one side of a wall to the other, it goes around an edge that near.
#pragma once

#include <cstdint>
#include <vector>

#include "forcelayer/pose.h"
#include "workbench/exact/body.h"
#include "workbench/exact/push_out.h"

namespace forcelayer::exact {

// A motion of a surface as the solid sees it: one that goes straight and turns evenly.
struct Motion {
  Pose from, middle, to;     // solid_from_surface
  Bend bend;                 // how far a place that comes into the solid leaves its straight way
  double half_travel_m = 0;  // and how far it is from where it is in the middle
};

// Those of some parts of a surface of which it is not proven that no place goes deeper. A part that
// is proven for a motion is so for each piece of that: only the others need be looked at again.
// Ends where it left more than `max_open` pieces. `cells` counts nodes and pieces. Adds to `met`
// the pieces that are proven, but may meet the solid.
Parts not_proven(const Parts& parts, const Body& surface, const Body& solid, const Motion& motion,
                 double allowed_m, std::size_t max_open, std::uint64_t& cells,
                 std::vector<part::Piece>& met);

// All places of a piece in a motion, but for its bend.
Hull hull_of(const Motion& motion, const part::Piece& piece);

// Whether a motion of which no place is deeper than `depth_m` is proven to keep its side.
bool keeps_side(const Body& solid, const Hull& hull, double depth_m, const Bend& bend);

}  // namespace forcelayer::exact

// Whether a surface stays allowed while it moves: no place of it goes deeper into a solid than it
// may, between two poses as at them.
//
// A triangle of the surface that moves is a convex set in the solid's frame: the hull of its
// corners at both ends, but for the bend of their ways. push_out.h settles it where a shift takes
// it out of the solid, and the distance from a triangle does where it lies on that (depth.h). What
// neither settles is cut.
#pragma once

#include <cstdint>

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
// Ends where it left more than `max_open` pieces. `cells` counts nodes and pieces.
Parts not_proven(const Parts& parts, const Body& surface, const Body& solid, const Motion& motion,
                 double allowed_m, std::size_t max_open, std::uint64_t& cells);

}  // namespace forcelayer::exact

// Places of one part that lie inside another one.
//
// A solid has an inside. The inside of an open mesh is not known, but a place that few directions
// lead out of may be in it.
#pragma once

#include <optional>

#include "workbench/pairs/pair_check.h"

namespace forcelayer::pairs {

// Whether a place is inside a solid, or may be inside an open mesh. The shape has a body.
bool may_hold(const Shape& shape, const part::Vec3& place_m);

// A place of the surface of `inner` that `outer` may hold, farther than `beyond_m` from the surface
// of `outer`. All triangles of `inner` that reach into the box of `outer` are looked at, or an
// even choice of them where they are many. Both have a body.
std::optional<part::Vec3> place_inside(const Shape& inner, const Shape& outer, double beyond_m);

// A ball that lies in both parts.
struct Ball {
  part::Vec3 center;
  double radius_m = 0;
};

// The largest ball that is found in both parts, larger than `min_m` and the cracks that are near:
// about the middle of their boxes, and about places below the largest triangles of the first, at
// depths of a half, a fourth and so on of its diagonal. Radius 0 where none is found. Both have a
// body.
Ball ball_in_both(const Shape& first, const Shape& second, double min_m);

}  // namespace forcelayer::pairs

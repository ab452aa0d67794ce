// The smallest ball around a set of points.
#pragma once

#include <span>

#include "pointshell/part/vec3.h"

namespace forcelayer::sample {

struct Ball {
  part::Vec3 center;
  double radius = 0;
};

// The smallest ball around `points` (at least one), up to rounding: by pivoting on the farthest
// point as in Gaertner, "Fast and robust smallest enclosing balls", 1999.
Ball smallest_ball(std::span<const part::Vec3> points);

}  // namespace forcelayer::sample

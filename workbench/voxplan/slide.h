// Motions that the floors of a seat allow.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "runtime/clearance/seat_stretch.h"
#include "workbench/voxplan/random.h"

namespace forcelayer::voxplan {

// A small motion: a shift of the centroid and a turn times the part's radius, along the world's
// axes. All six numbers are lengths, m.
using Twist6 = std::array<double, 6>;

// A random motion of that length: a shift alone, or a shift with a turn.
Twist6 random_twist(double length_m, Random& random);

double length_of(const Twist6& twist);
Twist6 of_length(Twist6 twist, double length_m);  // the same direction; `twist` is not zero

// The motion nearest to `wanted` that keeps all points in front of their floors, to first order. So
// a pin in a hole moves along its axis or turns about it, and a cover moves up.
Twist6 allowed_twist(const Twist6& wanted, std::span<const clearance::SeatStretch::Floor> floors,
                     double radius_m);

// A motion of length 1 in which the floors resist little: (A + e)^-1 times `wanted`. A is the mean
// of a a^T over the floors, and a . twist is the speed at which the point in front of a floor
// leaves it. So a pin gets a motion along its hole or about it, even if some floors disagree.
Twist6 free_twist(const Twist6& wanted, std::span<const clearance::SeatStretch::Floor> floors,
                  double radius_m);

// Straight directions that the floors suggest: away from all of them, and both directions along the
// axis that they resist least. Floors at edges lean along that axis. They are left out when the
// axis is computed, so that the others give it exactly.
std::vector<glm::dvec3> free_directions(std::span<const clearance::SeatStretch::Floor> floors);

Pose moved(const Pose& pose, const Twist6& twist, double radius_m);

}  // namespace forcelayer::voxplan

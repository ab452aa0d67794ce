// Motions that the floors of a seat allow.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "runtime/clearance/seat_stretch.h"
#include "workbench/voxplan/random.h"

namespace forcelayer::voxplan {

// A way of the centroid and a turn, world axes, both as lengths: the turn is times the part's
// radius.
using Twist6 = std::array<double, 6>;

// A random one of that length: a way alone, or with a turn.
Twist6 random_twist(double length_m, Random& random);

double length_of(const Twist6& twist);
Twist6 of_length(Twist6 twist, double length_m);  // the same direction, which it must have

// The twist nearest to `wanted` that leaves all points before their floors, to first order. So a
// pin in a hole goes along its axis or turns about it, and a cover goes up.
Twist6 allowed_twist(const Twist6& wanted, std::span<const clearance::SeatStretch::Floor> floors,
                     double radius_m);

// A twist of length 1 in which the floors resist little, from a random one: (A + e)^-1 times it,
// where A is the mean of a a^T over the floors, and a . twist is how fast the point before one
// leaves it. So a pin gets a way along its hole or a turn about it, though some floors say
// otherwise.
Twist6 free_twist(const Twist6& wanted, std::span<const clearance::SeatStretch::Floor> floors,
                  double radius_m);

// Directions in which a part may go straight, by its floors: away from all of them, and along the
// axis that they resist least, either way. Floors at edges, which lean along that axis, are left
// out of it, so that the others give it exactly.
std::vector<glm::dvec3> free_directions(std::span<const clearance::SeatStretch::Floor> floors);

Pose moved(const Pose& pose, const Twist6& twist, double radius_m);

}  // namespace forcelayer::voxplan

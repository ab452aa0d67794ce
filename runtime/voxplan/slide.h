// Motions that the floors of a seat allow.
#pragma once

#include <array>
#include <span>

#include "runtime/clearance/seat_stretch.h"
#include "runtime/voxplan/random.h"

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

Pose moved(const Pose& pose, const Twist6& twist, double radius_m);

}  // namespace forcelayer::voxplan

// The coupling's angle as a continuous function of the motion, past half a turn.
#pragma once

#include <cmath>

#include "forcelayer/pose.h"

namespace forcelayer::coupling {

// Rotation vector (rad, world axes) that turns the part to its target: of the two of up to a whole
// turn that do, the one nearer to `last`, that of the frame before. So a part that is held while
// the hand turns on past pi is still pulled back the way it came.
glm::dvec3 continuous_angle(const glm::dquat& part, const glm::dquat& target,
                            const glm::dvec3& last) noexcept;

// Fraction of the coupling's torque at an angle: all of it up to three quarters of a turn, fading
// to nothing at a whole turn, where the part is at its target again and no axis is left. So the
// torque is continuous there too.
double torque_fraction(double angle_rad) noexcept;

// Integral of the above from three quarters of a turn to `angle_rad`, rad; 0 below.
double faded_angle_rad(double angle_rad) noexcept;

inline constexpr double kFullTorqueRad = 1.5 * M_PI;

}  // namespace forcelayer::coupling

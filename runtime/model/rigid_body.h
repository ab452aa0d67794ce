// The free motion of one rigid body: mass properties and rotation on the group SO(3).
#pragma once

#include <glm/mat3x3.hpp>
#include <limits>

#include "forcelayer/pose.h"

namespace forcelayer::model {

// Mass properties about the center of mass, in the axes of the body.
struct RigidMass {
  double mass_kg = 1;
  glm::dmat3 inertia_kgm2{1};
  glm::dmat3 inverse_inertia_1pkgm2{1};
};

// The inertia `body` with its axes turned by `orientation`: R body R^T.
glm::dmat3 turned(const glm::dmat3& body, const glm::dquat& orientation) noexcept;

// m v^2 / 2 + w I w / 2, at the given orientation.
double kinetic_energy_j(const RigidMass& mass, const glm::dquat& orientation,
                        const Twist& velocity) noexcept;

// Moves a body for `dt_s` by a velocity that an impulse has just set: translation straight, and
// rotation with its angular momentum kept, so that an asymmetric body tumbles as it should (the
// midpoint rule on SO(3): second order, time-reversible, momentum exact). `velocity.angular_radps`
// becomes that at the end of the motion; the orientation is renormalised. A rotation too fast for
// the step loses momentum rather than gain energy. Where the momentum of an asymmetric body turns
// it by more than its first velocity would, `max_turn_rad` still bounds the angle. A zero velocity
// leaves every bit as it was.
Pose advance(const RigidMass& mass, const Pose& world_from_center, Twist& velocity, double dt_s,
             double max_turn_rad = std::numeric_limits<double>::infinity()) noexcept;

}  // namespace forcelayer::model

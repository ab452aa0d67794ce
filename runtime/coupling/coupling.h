// The virtual coupling (paper 5.1): how far and how fast the part is from where the handle pulls
// it.
#pragma once

#include "forcelayer/parameters.h"
#include "runtime/coupling/state.h"

namespace forcelayer::coupling {

// Where the part would be if the coupling were rigid, and how it would move there.
struct CouplingTarget {
  Pose world_from_center;  // world_from_handle * handle_from_center
  Twist velocity;          // of the centroid, world axes
};

// How far the part is from its target, and how fast it moves relative to it.
struct CouplingStretch {
  glm::dvec3 displacement_m;  // target less part
  glm::dvec3 rotation_rad;    // equivalent axis times angle that turns the part to the target,
                              // angle in [0, pi], world axes
  glm::dvec3 velocity_mps;    // part less target
  glm::dvec3 angular_radps;   // part less target
};

CouplingTarget coupling_target(const State& state, const StepInput& input) noexcept;
CouplingStretch coupling_stretch(const State& state, const CouplingTarget& target) noexcept;

// Equivalent axis times angle, in [0, pi], of a unit quaternion. Zero for the identity.
glm::dvec3 rotation_vector(const glm::dquat& rotation) noexcept;

// The unit quaternion that turns by |rotation_rad| about its direction.
glm::dquat rotation_by(const glm::dvec3& rotation_rad) noexcept;

}  // namespace forcelayer::coupling

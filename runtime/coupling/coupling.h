// The virtual coupling (paper 5.1): how far and how fast the part is from where the handle pulls
// it. The paper's model pulls the centroid, the default model the point that the hand holds.
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

// The same of the default model: where the hand pulls the grip, the handle's point of the part, and
// to which orientation it turns the part. The lever of the grip and the part's turn in the hand do
// not mix: a handle that turns about its origin pulls at nothing, however long the lever.
struct GripTarget {
  glm::dvec3 point_m{0};               // the handle's origin, world
  glm::dquat orientation{1, 0, 0, 0};  // of the part, world
  Twist velocity;                      // of the handle's origin, world axes
  glm::dvec3 lever_m{0};               // from the centroid to the grip, axes of the part
  // How the hand came here since the frame before, world axes; zero in a first frame.
  glm::dvec3 shift_m{0}, turn_rad{0};
};

GripTarget grip_target(const State& state, const StepInput& input) noexcept;

// Where the target was while a fraction of the frame was still left, on the straight way of the
// hand.
GripTarget earlier(const GripTarget& target, double left_fraction) noexcept;

// From the part's centroid to the grip, world axes.
inline glm::dvec3 grip_arm_m(const GripTarget& target, const Pose& world_from_center) noexcept {
  return world_from_center.orientation * target.lever_m;
}

// From the part's grip to the handle's origin, world axes.
inline glm::dvec3 grip_stretch_m(const GripTarget& target, const Pose& world_from_center) noexcept {
  return target.point_m - (world_from_center.position_m + grip_arm_m(target, world_from_center));
}

// Equivalent axis times angle, in [0, pi], of a unit quaternion. Zero for the identity.
glm::dvec3 rotation_vector(const glm::dquat& rotation) noexcept;

// The unit quaternion that turns by |rotation_rad| about its direction.
glm::dquat rotation_by(const glm::dvec3& rotation_rad) noexcept;

}  // namespace forcelayer::coupling

// Rigid poses, velocities and wrenches. Right-handed frames, SI units.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace forcelayer {

// a_from_b: x_a = orientation * x_b + position_m.
struct Pose {
  glm::dvec3 position_m{0, 0, 0};
  glm::dquat orientation{1, 0, 0, 0};  // w, x, y, z; unit
};

// a_from_c = a_from_b * b_from_c. The orientation is not renormalised.
inline Pose operator*(const Pose& a_from_b, const Pose& b_from_c) {
  return {a_from_b.orientation * b_from_c.position_m + a_from_b.position_m,
          a_from_b.orientation * b_from_c.orientation};
}

inline Pose inverse(const Pose& a_from_b) {
  const glm::dquat b_from_a = glm::conjugate(a_from_b.orientation);
  return {-(b_from_a * a_from_b.position_m), b_from_a};
}

// Velocity of a body: of the point that the variable's comment names, in the named frame's axes.
struct Twist {
  glm::dvec3 linear_mps{0, 0, 0};
  glm::dvec3 angular_radps{0, 0, 0};
};

// Force and torque about the point that the variable's comment names, in the named frame's axes.
struct Wrench {
  glm::dvec3 force_n{0, 0, 0};
  glm::dvec3 torque_nm{0, 0, 0};
};

}  // namespace forcelayer

// Limits of vectors, and whether vectors, poses and wrenches are finite.
#pragma once

#include <cmath>
#include <glm/geometric.hpp>

#include "forcelayer/pose.h"

namespace forcelayer::model {

// v, shortened to `limit` where it is longer.
inline glm::dvec3 clamped(const glm::dvec3& v, double limit) noexcept {
  const double length = glm::length(v);
  return length > limit ? v * (limit / length) : v;
}

inline bool is_finite(const glm::dvec3& v) noexcept {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline bool is_finite(const Twist& twist) noexcept {
  return is_finite(twist.linear_mps) && is_finite(twist.angular_radps);
}

inline bool is_finite(const Wrench& wrench) noexcept {
  return is_finite(wrench.force_n) && is_finite(wrench.torque_nm);
}

inline bool is_finite(const Pose& pose) noexcept {
  return is_finite(pose.position_m) && std::isfinite(glm::length(pose.orientation));
}

// Whether the length is 1 within `tolerance`: a device gives few bits, the loop itself nearly all.
// False for NaN.
inline bool is_unit(const glm::dquat& q, double tolerance) noexcept {
  return std::abs(glm::length(q) - 1) < tolerance;
}

}  // namespace forcelayer::model

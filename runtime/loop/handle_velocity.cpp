#include "runtime/loop/handle_velocity.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"

namespace forcelayer::loop {
namespace {

double median(double a, double b, double c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

// Median by component, or zero where it is longer than `longest`.
glm::dvec3 median(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, double longest) {
  const glm::dvec3 m(median(a.x, b.x, c.x), median(a.y, b.y, c.y), median(a.z, b.z, c.z));
  return glm::length(m) <= longest ? m : glm::dvec3(0);
}

// `estimate` without its part against `motion`.
glm::dvec3 not_against(const glm::dvec3& estimate, const glm::dvec3& motion) {
  const double against = glm::dot(estimate, motion);
  return against < 0 ? estimate - motion * (against / glm::dot(motion, motion)) : estimate;
}

}  // namespace

Twist HandleVelocity::update(const Pose& device_from_handle, double dt_s) noexcept {
  if (!known_) {
    known_ = true;
    last_ = device_from_handle;
    return velocity_;
  }
  const Twist now{(device_from_handle.position_m - last_.position_m) / dt_s,
                  coupling::rotation_vector(device_from_handle.orientation *
                                            glm::conjugate(last_.orientation)) /
                      dt_s};
  last_ = device_from_handle;
  differences_ = {now, differences_[0], differences_[1]};
  const auto& d = differences_;
  const glm::dvec3 linear_mps =
      median(d[0].linear_mps, d[1].linear_mps, d[2].linear_mps, kMaxSpeedMps);
  const glm::dvec3 angular_radps =
      median(d[0].angular_radps, d[1].angular_radps, d[2].angular_radps, kMaxTurnRadps);
  const double fraction = dt_s / (dt_s + kTimeConstantS);
  Twist& v = velocity_;
  v.linear_mps = not_against(v.linear_mps + (linear_mps - v.linear_mps) * fraction, now.linear_mps);
  v.angular_radps = not_against(v.angular_radps + (angular_radps - v.angular_radps) * fraction,
                                now.angular_radps);
  const bool still = now.linear_mps == glm::dvec3(0) && now.angular_radps == glm::dvec3(0) &&
                     glm::length(v.linear_mps) < kMinSpeedMps &&
                     glm::length(v.angular_radps) < kMinTurnRadps;
  if (still) v = {};
  return v;
}

}  // namespace forcelayer::loop

#include "runtime/devices/sim_hand.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace forcelayer {
namespace {

glm::dvec3 in_steps(const glm::dvec3& value, double step) {
  return step > 0 ? glm::floor(value / step + 0.5) * step : value;
}

}  // namespace

SimHand::SimHand(const SimHandParameters& parameters, const glm::dvec3& position_m)
    : p_(parameters), position_m_(position_m) {}

glm::dvec3 SimHand::delayed(const glm::dvec3& force_n) noexcept {
  newest_ = (newest_ + 1) % kQueue;
  queue_[static_cast<std::size_t>(newest_)] = force_n;
  const int late = std::clamp(static_cast<int>(std::lround(p_.delay_s / kSubstepS)), 0, kQueue - 1);
  return queue_[static_cast<std::size_t>((newest_ + kQueue - late) % kQueue)];
}

glm::dvec3 SimHand::step(const glm::dvec3& wanted_m, const glm::dvec3& force_n,
                         double dt_s) noexcept {
  const double mass_kg = p_.device_mass_kg + p_.hand_mass_kg;
  const double damping = p_.device_damping_ns_per_m + p_.hand_damping_ns_per_m;
  const glm::dvec3 output_n = in_steps(force_n, p_.force_step_n);
  const int substeps = std::max(1, static_cast<int>(std::lround(dt_s / kSubstepS)));
  const double h = dt_s / substeps;
  for (int i = 0; i < substeps; ++i) {
    const glm::dvec3 pull_n = p_.hand_stiffness_n_per_m * (wanted_m - position_m_);
    // Implicit in the damping, and friction that stops but never drives.
    glm::dvec3 momentum = mass_kg * velocity_mps_ + h * (pull_n + delayed(output_n));
    const double size = glm::length(momentum);
    if (size > 0) momentum *= std::max(0.0, 1 - h * p_.device_friction_n / size);
    velocity_mps_ = momentum / (mass_kg + h * damping);
    position_m_ += h * velocity_mps_;
  }
  return in_steps(position_m_, p_.encoder_step_m);
}

}  // namespace forcelayer

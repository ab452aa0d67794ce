#include "runtime/devices/sim_hand.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"
#include "runtime/model/vectors.h"

namespace forcelayer::devices {
namespace {

glm::dvec3 in_steps(const glm::dvec3& value, double step) {
  return step > 0 ? glm::floor(value / step + 0.5) * step : value;
}

// A velocity after `h` under `push`: implicit in the damping, and with Coulomb friction that stops
// but never drives. `inertia` is a mass or a moment.
glm::dvec3 after_push(const glm::dvec3& velocity, const glm::dvec3& push, double inertia,
                      double damping, double friction, double h) {
  glm::dvec3 momentum = inertia * velocity + h * push;
  const double size = glm::length(momentum);
  if (size > 0) momentum *= std::max(0.0, 1 - h * friction / size);
  return momentum / (inertia + h * damping);
}

glm::dvec3 turn_between(const glm::dquat& from, const glm::dquat& to) {
  return coupling::rotation_vector(to * glm::conjugate(from));
}

}  // namespace

SimHandParameters loose_grip() {
  SimHandParameters p;
  p.hand_mass_kg = p.hand_damping_ns_per_m = 0;
  p.hand_stiffness_n_per_m = 50;
  p.hand_inertia_kgm2 = p.hand_damping_nms_per_rad = 0;
  p.hand_stiffness_nm_per_rad = 0.05;
  return p;
}

SimHand::SimHand(const SimHandParameters& parameters, const Pose& handle)
    : p_(parameters), home_(handle), pose_(handle) {}

Wrench SimHand::delayed(const Wrench& wrench) noexcept {
  newest_ = (newest_ + 1) % kQueue;
  queue_[static_cast<std::size_t>(newest_)] = wrench;
  const int late = std::clamp(static_cast<int>(std::lround(p_.delay_s / kSubstepS)), 0, kQueue - 1);
  return queue_[static_cast<std::size_t>((newest_ + kQueue - late) % kQueue)];
}

void SimHand::turn(const Pose& wanted, const glm::dvec3& torque_nm, double h) noexcept {
  const glm::dvec3 pull_nm = model::clamped(
      p_.hand_stiffness_nm_per_rad * turn_between(pose_.orientation, wanted.orientation),
      p_.hand_torque_nm);
  velocity_.angular_radps = after_push(
      velocity_.angular_radps, pull_nm + torque_nm, p_.device_inertia_kgm2 + p_.hand_inertia_kgm2,
      p_.device_damping_nms_per_rad + p_.hand_damping_nms_per_rad, p_.device_friction_nm, h);
  pose_.orientation =
      glm::normalize(coupling::rotation_by(h * velocity_.angular_radps) * pose_.orientation);
}

Pose SimHand::encoded() const noexcept {
  const glm::dvec3 angle = turn_between(home_.orientation, pose_.orientation);
  return {in_steps(pose_.position_m, p_.encoder_step_m),
          coupling::rotation_by(in_steps(angle, p_.encoder_step_rad)) * home_.orientation};
}

Pose SimHand::step(const Pose& wanted, const Wrench& on_hand, double dt_s) noexcept {
  const Wrench output{in_steps(on_hand.force_n, p_.force_step_n),
                      in_steps(on_hand.torque_nm, p_.torque_step_nm)};
  const int substeps = std::max(1, static_cast<int>(std::lround(dt_s / kSubstepS)));
  const double h = dt_s / substeps;
  for (int i = 0; i < substeps; ++i) {
    const Wrench felt = delayed(output);
    const glm::dvec3 pull_n = model::clamped(
        p_.hand_stiffness_n_per_m * (wanted.position_m - pose_.position_m), p_.hand_force_n);
    velocity_.linear_mps =
        after_push(velocity_.linear_mps, pull_n + felt.force_n, p_.device_mass_kg + p_.hand_mass_kg,
                   p_.device_damping_ns_per_m + p_.hand_damping_ns_per_m, p_.device_friction_n, h);
    pose_.position_m += h * velocity_.linear_mps;
    turn(wanted, felt.torque_nm, h);
  }
  return encoded();
}

}  // namespace forcelayer::devices

// A hand on a device, simulated: what the loop's stability is tested on beside a prescribed handle.
// Translation only; the handle's orientation is that of the script.
#pragma once

#include <array>
#include <glm/vec3.hpp>

namespace forcelayer {

// Device mechanics as makers and papers state them; arm and hand as measured in the literature on a
// grip (200-1000 N/m, 5-20 N s/m, 0.1-1 kg moving with the handle). All zero for the hand: let go.
struct SimHandParameters {
  double device_mass_kg = 0.2;
  double device_damping_ns_per_m = 2;
  double device_friction_n = 0.05;  // Coulomb
  double hand_mass_kg = 0.3;        // that moves with the handle
  double hand_stiffness_n_per_m = 400;
  double hand_damping_ns_per_m = 8;
  double encoder_step_m = 25e-6;  // paper 6.1
  double force_step_n = 0.01;
  double delay_s = 0.001;  // from the loop's output to the force, at most kMaxDelayS
};

// The hand pulls the handle towards where it wants to be; the device adds the loop's force, late
// and in steps, and reports the handle's position in encoder steps.
class SimHand {
 public:
  static constexpr double kMaxDelayS = 0.005;

  SimHand(const SimHandParameters& parameters, const glm::dvec3& position_m);

  // Advances by one tick of the loop, `force_n` being the loop's newest output on the hand. Returns
  // what the device reports.
  glm::dvec3 step(const glm::dvec3& wanted_m, const glm::dvec3& force_n, double dt_s) noexcept;

  const glm::dvec3& position_m() const { return position_m_; }

 private:
  static constexpr double kSubstepS = 5e-5;
  static constexpr int kQueue = 101;  // substeps of kMaxDelayS, and one

  glm::dvec3 delayed(const glm::dvec3& force_n) noexcept;

  SimHandParameters p_;
  glm::dvec3 position_m_, velocity_mps_{0};
  std::array<glm::dvec3, kQueue> queue_{};
  int newest_ = 0;
};

}  // namespace forcelayer

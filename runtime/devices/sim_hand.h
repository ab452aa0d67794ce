// A hand on a device, simulated in six degrees of freedom. The loop's stability is tested on it and
// on a prescribed handle.
#pragma once

#include <array>

#include "forcelayer/pose.h"

namespace forcelayer::devices {

// Device mechanics as makers and papers state them (paper 6.1: steps of 0.025 mm and 0.013 degrees;
// 6.4: 15 N, 0.1 N m); arm and hand of the order measured on grips (200-1000 N/m, 5-20 N s/m and
// 0.1-1 kg that move with the handle; 0.5-4 N m/rad about it). The defaults are a firm grip.
struct SimHandParameters {
  double device_mass_kg = 0.2;
  double device_damping_ns_per_m = 2;
  double device_friction_n = 0.05;  // Coulomb
  double hand_mass_kg = 0.3;        // that moves with the handle
  double hand_stiffness_n_per_m = 400;
  double hand_damping_ns_per_m = 8;
  double hand_force_n = 15;  // most that the hand pulls with

  double device_inertia_kgm2 = 2e-4;  // about the handle's origin, the same about every axis
  double device_damping_nms_per_rad = 0.005;
  double device_friction_nm = 5e-4;
  double hand_inertia_kgm2 = 4e-4;
  double hand_stiffness_nm_per_rad = 1.5;
  double hand_damping_nms_per_rad = 0.03;
  double hand_torque_nm = 0.5;  // most that it turns with

  double encoder_step_m = 25e-6;
  double encoder_step_rad = 2.3e-4;
  double force_step_n = 0.01;
  double torque_step_nm = 1e-4;
  double delay_s = 0.001;  // from the loop's output to the force, at most SimHand::kMaxDelayS
};

// The same device held between two fingers: nothing of the hand's mass and damping helps to calm
// it. The worst case for the loop's stability.
SimHandParameters loose_grip();

// The hand pulls and turns the handle towards where it wants it; the device adds the loop's wrench,
// late and in steps, and reports the handle's pose in encoder steps. All in the device's frame, or
// any other that does not move.
class SimHand {
 public:
  static constexpr double kMaxDelayS = 0.005;

  // At rest at `handle`.
  SimHand(const SimHandParameters& parameters, const Pose& handle);

  // Advances by one tick of the loop, `on_hand` being the loop's newest output, about the handle's
  // origin. Returns the encoders' pose.
  Pose step(const Pose& wanted, const Wrench& on_hand, double dt_s) noexcept;

  const Pose& pose() const { return pose_; }  // the handle itself, between the encoder's steps

 private:
  static constexpr double kSubstepS = 5e-5;
  static constexpr int kQueue = 101;  // substeps of kMaxDelayS, and one

  Wrench delayed(const Wrench& wrench) noexcept;
  void turn(const Pose& wanted, const glm::dvec3& torque_nm, double h) noexcept;
  Pose encoded() const noexcept;

  SimHandParameters p_;
  Pose home_;  // where the encoders read zero angle
  Pose pose_;
  Twist velocity_;
  std::array<Wrench, kQueue> queue_{};
  int newest_ = 0;
};

}  // namespace forcelayer::devices

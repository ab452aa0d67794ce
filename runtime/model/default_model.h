// The project's own dynamic model: implicit in coupling, contacts and braking, guarded, and at rest
// when the hand rests, whatever the stiffness, mass and rate.
//
// A frame is one or more motions of at most s/2 of travel. Each is solved, looked up where it
// leads, and kept only if the guard accepts it (runtime/guard) and its energy is in order
// (motion_allowance.h); the pose that was looked up is the pose that is kept, bit for bit. A motion
// that fails is solved again with the contacts found where it led, then shortened, then dropped.
#pragma once

#include <vector>

#include "forcelayer/parameters.h"
#include "runtime/coupling/state.h"
#include "runtime/field/contact_set.h"
#include "runtime/model/contact_force.h"
#include "runtime/model/rigid_body.h"

namespace forcelayer::model {

// The stiffness of one contact point of mean area on a rigid scene: 150 k_T, so that behind the
// coupling it feels within 0.7% as stiff as many, and at least what pushes with the coupling's
// force limit at a depth of 0.15 voxel, which is before the guard stops the part.
// Beneath a covering the guard, which goes by voxels, may stop it before.
inline constexpr double kRigidOverCoupling = 150;
double rigid_stiffness_n_per_m(const Parameters& parameters) noexcept;

class DefaultModel {
 public:
  // `probe` must outlive the model; `points` is the shell's number of points.
  DefaultModel(const Parameters& parameters, field::ContactProbe& probe, std::uint64_t points,
               const field::ForceCurve& curve = {});

  // One frame. A pure function of its arguments and of the constructor's. The wrench is the
  // reaction of the coupling on the hand, which acts at the grip: the hand feels no torque but that
  // of the rotational spring. Exactly zero when every point is free.
  StepResult step(State& state, const StepInput& input, double dt_s) noexcept;

 private:
  struct Motion;  // one sub-step in the making

  // The contacts at one pose, and what follows from them.
  struct LookUp : field::ContactSet {
    ContactTotals totals;
    double energy_j = 0;  // of the contact springs
  };

  void query_pose(const Pose& pose, LookUp& out) noexcept;

  void open_seat(bool open) noexcept;
  void query_here(const Pose& pose) noexcept;
  void report_distance(StepReport& report) const noexcept;
  void refill_allowance(State& state, const coupling::GripTarget& target, const Pose& handle,
                        double dt_s) const noexcept;
  void move(State& state, const coupling::GripTarget& target, double dt_s,
            StepReport& report) noexcept;
  Motion prepare(const State& state, const coupling::GripTarget& target,
                 double dt_s) const noexcept;
  void pull_to(const coupling::GripTarget& target, const State& state,
               Motion& motion) const noexcept;
  void choose(Motion& motion, const State& state, double remaining_s, double dt_s) noexcept;
  void solve_motion(Motion& motion, double dt_s) noexcept;
  bool try_motion(State& state, Motion& motion, StepReport& report) noexcept;
  bool affordable(const State& state, const Motion& motion, const Pose& candidate, double kinetic_j,
                  double& rise_j) const noexcept;
  std::uint32_t object_barring(const Pose& pose) const noexcept;
  void add_found_contacts(Motion& motion) noexcept;
  void limit_travel(Motion& motion) const noexcept;
  Pose moved(const Pose& from, const coupling::GripTarget& target, Motion& motion,
             Twist& velocity) const noexcept;
  double travel_m(const Motion& motion, double dt_s) const noexcept;
  double potential_j(const glm::dvec3& displacement_m, const glm::dvec3& angle_rad,
                     const LookUp& contacts) const noexcept;
  coupling::CouplingHalf rotation_at(const glm::dvec3& angle_rad,
                                     const glm::dquat& orientation) const noexcept;
  double angle_energy_j(const glm::dvec3& angle_rad) const noexcept;
  Wrench wrench_on_hand(State& state, const coupling::GripTarget& target, const Twist& velocity,
                        double dt_s, StepReport& report) const noexcept;

  Parameters parameters_;
  RigidMass mass_;
  std::vector<ContactLaw> laws_;  // of the scene's surface, and of the rigid core of a covering
  coupling::CouplingHalf translation_, rotation_;
  glm::dmat3 rotation_damping_;  // N m s/rad, axes of the part
  field::ContactProbe& probe_;
  LookUp here_, there_;  // at the part's pose, and where a motion would lead
  Pose here_pose_;
  bool here_known_ = false;
  bool seat_open_ = false;  // as the probe has it
  ContactRows rows_;
};

}  // namespace forcelayer::model

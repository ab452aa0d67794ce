#include "runtime/model/default_model.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "runtime/coupling/coupling_angle.h"
#include "runtime/coupling/passivity.h"
#include "runtime/field/surface_clearance.h"
#include "runtime/guard/point_rule.h"
#include "runtime/model/motion_allowance.h"
#include "runtime/model/principal_inertia.h"
#include "runtime/model/touched_objects.h"
#include "runtime/model/vectors.h"

namespace forcelayer::model {
namespace {

constexpr int kResolves = 2;                // new solves with the contacts found where a motion led
constexpr int kHalvings = 2;                // shortenings after that; then the part stays
constexpr double kTravelMargin = 1 - 1e-9;  // keeps s/2 from being reached by rounding

// A motion shorter than this fraction of a voxel is not made while the hand rests.
constexpr double kMinTravelVoxels = 1e-9;
// While the hand rests, a motion must lower the energy by this fraction of k_T times its square.
constexpr double kDescentFraction = 1e-4;

// Where a barred point must end, behind where a force layer of one voxel begins to push. That is
// 0.1 to 0.8 voxels before the guard's place, by the kind of map.
constexpr double kGuardDepthVoxels = 0.4;
// At least so far it is pushed back per new solve.
constexpr double kGuardPushVoxels = 0.15;
// The same of a point that went through a sheet: less than that would be rounding.
constexpr double kSheetPushVoxels = 0.002;
// Stiffness of a guard's row over that of a contact: hard, but well-conditioned.
constexpr double kGuardHardness = 100;

constexpr double kHoldDepthVoxels = 0.15;  // the field has s/8 at a convex corner, s/2 at a face

// How b_R is shared among the axes: critical damping about each, 2 sqrt(I k_R), over its largest.
glm::dmat3 critical_damping_shape(const glm::dmat3& inertia_kgm2) {
  PrincipalInertia inertia = principal_inertia(inertia_kgm2);
  const glm::dvec3 m = inertia.moments;
  const double largest = std::max({m.x, m.y, m.z});
  for (int axis = 0; axis < 3; ++axis) inertia.moments[axis] = std::sqrt(m[axis] / largest);
  return tensor_of(inertia);
}

// The damping of one contact point of mean area. Damping over stiffness, which is the time in which
// a contact gives way, is that of the point alone, or that of the coupling where the coupling is
// the stiffer: a soft covering gives way as fast for many points of little area as for a few.
double contact_damping_ns_per_m(const Parameters& p, double field_n_per_m) {
  const double stiffness_n_per_m = std::max(field_n_per_m, p.coupling_n_per_m);
  return p.contact_damping_ratio * std::sqrt(p.mass_kg / stiffness_n_per_m) * field_n_per_m;
}

// The scene pushes the part with its surface, and where that is soft, with the rigid scene beneath
// it. There the covering's last force stays, and that of a rigid scene begins from nothing.
std::vector<ContactLaw> contact_laws(const Parameters& p, const field::ForceCurve& curve) {
  std::vector<ContactLaw> laws;
  const auto add = [&](double field_n_per_m, double min_areas, const field::ForceCurve& over_depth,
                       double begin_m) {
    laws.push_back({field_n_per_m, contact_damping_ns_per_m(p, field_n_per_m), min_areas,
                    over_depth, begin_m});
  };
  add(p.field_n_per_m, curve.is_straight() ? 1 : 0, curve, 0);
  if (!curve.is_straight()) add(rigid_stiffness_n_per_m(p), 1, {}, curve.end_m());
  return laws;
}

// Mean velocity of the part over a frame: of its grip, world axes.
Twist mean_velocity(const coupling::GripTarget& target, const Pose& from, const Pose& to,
                    double dt_s) {
  if (!(dt_s > 0)) return {};
  const glm::dvec3 shift_m = to.position_m - from.position_m + coupling::grip_arm_m(target, to) -
                             coupling::grip_arm_m(target, from);
  return {shift_m / dt_s,
          coupling::rotation_vector(to.orientation * glm::conjugate(from.orientation)) / dt_s};
}

// The angle from the part at a pose to its target, continuous with that of the state.
glm::dvec3 angle_rad(const State& state, const coupling::GripTarget& target, const Pose& part) {
  return coupling::continuous_angle(part.orientation, target.orientation, state.coupling_angle_rad);
}

// The velocity of the point at an arm from the point whose velocity is given.
Twist at_arm(const Twist& velocity, const glm::dvec3& arm_m) {
  return {velocity.linear_mps + glm::cross(velocity.angular_radps, arm_m), velocity.angular_radps};
}

template <typename T>
bool same_bits(const T& a, const T& b) {
  static_assert(std::is_trivially_copyable_v<T>);
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

}  // namespace

// One sub-step in the making.
struct DefaultModel::Motion {
  StepSystem system;
  coupling::Vector6 start{};     // velocity before
  coupling::Vector6 velocity{};  // velocity of the motion
  coupling::GripTarget target;   // at the motion's end
  double energy_before_j = 0;
};

double rigid_stiffness_n_per_m(const Parameters& p) noexcept {
  const double hold = p.coupling_force_limit_n / (kHoldDepthVoxels * p.voxel_size_m);
  return std::max(hold, kRigidOverCoupling * p.coupling_n_per_m);
}

DefaultModel::DefaultModel(const Parameters& parameters, field::ContactProbe& probe,
                           std::uint64_t points, const field::ForceCurve& curve)
    : parameters_(parameters), probe_(probe) {
  mass_ = {parameters.mass_kg, parameters.inertia_kgm2, glm::inverse(parameters.inertia_kgm2)};
  laws_ = contact_laws(parameters, curve);
  translation_ = {parameters.coupling_n_per_m, glm::dmat3(parameters.coupling_ns_per_m),
                  parameters.coupling_force_limit_n};
  rotation_ = {parameters.coupling_nm_per_rad, glm::dmat3(0), parameters.coupling_torque_limit_nm};
  rotation_damping_ =
      parameters.coupling_nms_per_rad * critical_damping_shape(parameters.inertia_kgm2);
  here_.reserve(points);
  there_.reserve(points);
  // The contacts here, those found by each new solve, and the brake.
  rows_.reserve((1 + kResolves) * laws_.size() * points + 1);
}

StepResult DefaultModel::step(State& state, const StepInput& input, double dt_s) noexcept {
  StepResult result;
  const coupling::GripTarget target = coupling::grip_target(state, input);
  open_seat(state.seat != kSeatClosed);
  query_here(state.world_from_center);
  const bool hand_still = state.has_handle != 0 &&
                          same_bits(input.world_from_handle, state.world_from_handle) &&
                          same_bits(input.handle_velocity, state.handle_velocity);
  refill_allowance(state, target, input.world_from_handle, dt_s);
  if (!hand_still) state.settled = 0;
  const Pose before = state.world_from_center;
  if (state.settled == 0) move(state, target, dt_s, result.report);
  const Twist velocity = mean_velocity(target, before, state.world_from_center, dt_s);
  result.at_handle = wrench_on_hand(state, target, velocity, dt_s, result.report);
  const glm::dvec3 arm_m = coupling::grip_arm_m(target, state.world_from_center);
  result.wrench = {result.at_handle.force_n,
                   result.at_handle.torque_nm + glm::cross(arm_m, result.at_handle.force_n)};
  StepReport& report = result.report;
  report.world_from_center = state.world_from_center;
  report.interior = here_.interior;
  report.surface = here_.surface;
  report.proximity = here_.proximity;
  report.contacts = here_.totals.count;
  report.depth_m = double{here_.totals.depth_m};
  report.outside_map = here_.outside_map ? 1 : 0;
  report.barred = here_.barred;
  report.seated = here_.seated;
  if (here_.seated > 0) state.seat = kSeatEntered;
  // No point is within force layer or guard of the seat's objects: with the seat and without it the
  // same points are pushed and barred.
  if (here_.seated == 0 && state.seat == kSeatEntered) state.seat = kSeatClosed;
  report.seat_open = state.seat != kSeatClosed ? 1 : 0;
  report_distance(report);
  const StoppedBy stop{state.stopped_by, -result.at_handle.force_n};
  report_touched(here_, here_.totals, laws_, probe_, stop, report);
  return result;
}

// The least distance of a shell point; Simulation makes a clearance of it.
void DefaultModel::report_distance(StepReport& report) const noexcept {
  const field::PoseClearance smallest =
      field::point_clearance(here_, report.world_from_center.position_m, probe_);
  report.clearance_m = smallest.clearance_m;
  report.clearance_kind = smallest.kind;
  report.nearest_point_m = smallest.nearest_point_m;
  report.nearest_object = smallest.nearest_object;
}

void DefaultModel::open_seat(bool open) noexcept {
  if (open == seat_open_) return;
  probe_.open_seat(open);
  seat_open_ = open;
  here_known_ = false;
}

void DefaultModel::query_pose(const Pose& pose, LookUp& out) noexcept {
  probe_.query_pose(pose, out);
  out.totals = contact_totals(out, laws_[0]);
  out.energy_j = contact_energy_j(out.totals, laws_[0]);
  if (laws_.size() == 1 || !(double{out.totals.depth_m} > laws_[1].begin_m)) return;
  out.energy_j += contact_energy_j(contact_totals(out, laws_[1]), laws_[1]);
}

void DefaultModel::query_here(const Pose& pose) noexcept {
  if (here_known_ && same_bits(pose, here_pose_)) return;
  query_pose(pose, here_);
  here_pose_ = pose;
  here_known_ = true;
}

void DefaultModel::refill_allowance(State& state, const coupling::GripTarget& target,
                                    const Pose& handle, double dt_s) const noexcept {
  double work_j = 0;
  if (state.has_handle != 0) {
    const Pose& last = state.world_from_handle;
    const double stretch_m =
        glm::length(coupling::grip_stretch_m(target, state.world_from_center)) +
        glm::length(handle.position_m - last.position_m);
    const double force_n = std::min(translation_.limit, translation_.stiffness * stretch_m);
    const double torque_nm = std::min(
        rotation_.limit, rotation_.stiffness * (glm::length(state.coupling_angle_rad) + 1));
    work_j = handle_work_j(last, handle, force_n, torque_nm);
  }
  const AllowanceLaw law{parameters_.allowance_j, parameters_.allowance_fade_s};
  state.allowance_j = faded_allowance_j(state.allowance_j, work_j, law, dt_s);
}

// One frame: motions of at most s/2 until the time or the look-ups are used up. What is left of the
// time then is not made up: the part lags, and follows in the next frames.
//
// Each motion is pulled to where the hand is when the motion ends. The hand comes evenly to its
// pose at the end of the frame. A motion of a fraction of the frame that was pulled there already
// would store a stretch of the spring that the hand makes only later. The part would spend it on
// running ahead of the hand, and give its kinetic energy back in contact: energy for which nobody
// worked.
void DefaultModel::move(State& state, const coupling::GripTarget& target, double dt_s,
                        StepReport& report) noexcept {
  double remaining_s = dt_s;
  state.stopped_by = 0;
  for (int look_ups = 0; look_ups < parameters_.look_ups && remaining_s > 1e-9 * dt_s; ++look_ups) {
    Motion motion = prepare(state, target, dt_s);
    choose(motion, state, remaining_s, dt_s);
    if (!try_motion(state, motion, report)) {
      state.velocity = {};
      state.settled = 1;
      return;
    }
    remaining_s -= motion.system.dt_s;
  }
}

DefaultModel::Motion DefaultModel::prepare(const State& state, const coupling::GripTarget& target,
                                           double dt_s) const noexcept {
  Motion motion;
  StepSystem& system = motion.system;
  // The apparent mass sits at the grip, not at the centroid: there the spring can neither swing it
  // nor tip it over.
  system.arm_m = coupling::grip_arm_m(target, state.world_from_center);
  coupling::add_at_arm(glm::dmat3(mass_.mass_kg), system.arm_m, system.inertia);
  coupling::add_block(turned(mass_.inertia_kgm2, state.world_from_center.orientation), 3,
                      system.inertia);
  motion.start = coupling::vector6(state.velocity.linear_mps, state.velocity.angular_radps);
  system.momentum = system.inertia * motion.start;
  system.translation = translation_;
  system.dt_s = dt_s;
  pull_to(target, state, motion);
  return motion;
}

// Makes `target` what pulls the part in the motion.
void DefaultModel::pull_to(const coupling::GripTarget& target, const State& state,
                           Motion& motion) const noexcept {
  StepSystem& system = motion.system;
  motion.target = target;
  system.displacement = {coupling::grip_stretch_m(target, state.world_from_center),
                         target.velocity.linear_mps};
  system.angle = {angle_rad(state, target, state.world_from_center), target.velocity.angular_radps};
  system.rotation = rotation_at(system.angle.displacement, state.world_from_center.orientation);
  motion.energy_before_j =
      kinetic_energy_j(mass_, state.world_from_center.orientation,
                       at_arm(state.velocity, system.arm_m)) +
      potential_j(system.displacement.displacement, system.angle.displacement, here_);
}

// Solves for all of the remaining time; where that would travel beyond s/2, for an even fraction of
// it, at whose end the hand has not yet come to its pose of this frame.
void DefaultModel::choose(Motion& motion, const State& state, double remaining_s,
                          double dt_s) noexcept {
  solve_motion(motion, remaining_s);
  const double fractions =
      std::ceil(travel_m(motion, remaining_s) /
                (kTravelMargin * guard::kMaxTravelVoxels * parameters_.voxel_size_m));
  if (fractions > 1) {
    const double left_s = remaining_s - remaining_s / fractions;
    pull_to(coupling::earlier(motion.target, left_s / dt_s), state, motion);
    solve_motion(motion, remaining_s / fractions);
  }
  limit_travel(motion);
}

void DefaultModel::solve_motion(Motion& motion, double dt_s) noexcept {
  motion.system.dt_s = dt_s;
  rows_.clear();
  for (const ContactLaw& law : laws_) {
    add_contact_rows(here_, law, dt_s, 0.5 * parameters_.voxel_size_m, rows_);
  }
  ContactRow brake;
  if (parameters_.braking && braking_row(here_, motion.system.inertia, motion.start, dt_s, brake)) {
    rows_.add(brake);
  }
  motion.velocity = solve_velocity(motion.system, rows_, motion.start);
}

// Looks up where the motion leads and keeps it, or mends it until it can be kept. False: the part
// stays where it is.
bool DefaultModel::try_motion(State& state, Motion& motion, StepReport& report) noexcept {
  const coupling::GripTarget& target = motion.target;
  const double dt_s = motion.system.dt_s;
  const double min_m = state.allowance_j == 0 ? kMinTravelVoxels * parameters_.voxel_size_m : 0;
  bool cut = false;
  for (int attempt = 0; attempt <= kResolves + kHalvings; ++attempt) {
    if (!(travel_m(motion, dt_s) > min_m)) return false;
    const Twist first{coupling::linear_part(motion.velocity),
                      coupling::angular_part(motion.velocity)};
    const double kinetic_j = kinetic_energy_j(mass_, state.world_from_center.orientation,
                                              at_arm(first, motion.system.arm_m));
    Twist velocity;
    const Pose candidate = moved(state.world_from_center, target, motion, velocity);
    query_pose(candidate, there_);
    probe_.mark_crossings(
        here_, glm::vec3(candidate.position_m - state.world_from_center.position_m), there_);
    double rise_j = 0;
    const bool clear = guard::accepts_pose(here_, there_);
    if (!clear) state.stopped_by = object_barring(candidate);
    if (clear && affordable(state, motion, candidate, kinetic_j, rise_j)) {
      state.allowance_j = std::max(0.0, state.allowance_j - rise_j);
      state.coupling_angle_rad = angle_rad(state, target, candidate);
      state.world_from_center = here_pose_ = candidate;
      state.velocity = velocity;
      std::swap(here_, there_);
      return true;
    }
    if (attempt < kResolves) {
      add_found_contacts(motion);
      motion.velocity = solve_velocity(motion.system, rows_, motion.velocity);
      limit_travel(motion);
    } else {
      report.guard_cuts += !clear && !cut ? 1 : 0;
      cut |= !clear;
      for (double& component : motion.velocity) component *= 0.5;
    }
  }
  return false;
}

// The object at the deepest point that bars a pose and does not bar the present one.
std::uint32_t DefaultModel::object_barring(const Pose& pose) const noexcept {
  std::uint32_t deepest = there_.count, at = 0;
  for (std::uint32_t i = 0; i < there_.count; ++i) {
    if (there_.is_barred[i] == 0) continue;
    while (at < here_.count && here_.point[at] < there_.point[i]) ++at;
    const bool barred_here =
        at < here_.count && here_.point[at] == there_.point[i] && here_.is_barred[at] != 0;
    if (barred_here) continue;
    if (deepest == there_.count || there_.depth_m[i] > there_.depth_m[deepest]) deepest = i;
  }
  if (deepest == there_.count) return 0;
  return probe_.object_near(pose.position_m + glm::dvec3(there_[deepest].arm_m));
}

bool DefaultModel::affordable(const State& state, const Motion& motion, const Pose& candidate,
                              double kinetic_j, double& rise_j) const noexcept {
  if (here_.barred > 0) return true;  // led out: slow, and its energy is not the scene's
  if (here_.in_free_space() && there_.in_free_space()) return true;  // nothing to gain it from
  const double energy_j =
      kinetic_j + potential_j(coupling::grip_stretch_m(motion.target, candidate),
                              angle_rad(state, motion.target, candidate), there_);
  const double travel = travel_m(motion, motion.system.dt_s);
  const double descent_j = kDescentFraction * parameters_.coupling_n_per_m * travel * travel;
  rise_j = energy_j + descent_j - motion.energy_before_j;
  return rise_j <= state.allowance_j;
}

// Adds the contacts of the pose to which the motion led, linearised there: as springs, and for
// barred points as hard rows that take them back into the force layer.
void DefaultModel::add_found_contacts(Motion& motion) noexcept {
  const double dt_s = motion.system.dt_s, s = parameters_.voxel_size_m;
  const double guard_depth_m = kGuardDepthVoxels * s + laws_[0].curve.deepening_m();
  for (std::uint32_t i = 0; i < there_.count; ++i) {
    if (!(there_.depth_m[i] > 0)) continue;
    const field::Contact c = there_[i];
    const double separation = coupling::dot(separation_row(c), motion.velocity);
    if (!c.barred) {
      for (const ContactLaw& law : laws_) {
        rows_.add(spring_row(c, law.force_m(c) + law.slope(c) * dt_s * separation, law, dt_s));
      }
      continue;
    }
    ContactRow row;
    row.j = separation_row(c);
    row.weight =
        kGuardHardness * dt_s * dt_s * laws_.back().stiffness_n_per_m + 1e3 * mass_.mass_kg;
    // A point that went through a sheet ends a little before its middle; others are led back into
    // the force layer.
    const double back_m = there_.is_barred[i] == field::ContactSet::kCrossed
                              ? double{c.depth_m} + kSheetPushVoxels * s
                              : std::max(kGuardPushVoxels * s, c.depth_m - guard_depth_m);
    row.onset = separation + back_m / dt_s;
    rows_.add(row);
  }
}

void DefaultModel::limit_travel(Motion& motion) const noexcept {
  const double dt_s = motion.system.dt_s;
  double limit_m = kTravelMargin * guard::kMaxTravelVoxels * parameters_.voxel_size_m;
  if (here_.barred > 0) limit_m = std::min(limit_m, parameters_.recovery_mps * dt_s);
  const double travel = travel_m(motion, dt_s);
  if (!(travel > limit_m)) return;
  for (double& component : motion.velocity) component *= limit_m / travel;
}

// Where a motion leads. The mass turns about the grip and carries the centroid round it; so a body
// that tumbles may go farther than its first velocity says, by a few per cent for long parts. Then
// it goes slower: s/2 holds for the pose itself.
Pose DefaultModel::moved(const Pose& from, const coupling::GripTarget& target, Motion& motion,
                         Twist& velocity) const noexcept {
  const double dt_s = motion.system.dt_s;
  const double limit_m = guard::kMaxTravelVoxels * parameters_.voxel_size_m;
  const glm::dvec3& arm_m = motion.system.arm_m;
  for (double fraction = 1; fraction > 1e-3; fraction *= 0.5) {
    const Twist first{fraction * coupling::linear_part(motion.velocity),
                      fraction * coupling::angular_part(motion.velocity)};
    const double left_m = kTravelMargin * limit_m - dt_s * glm::length(first.linear_mps);
    velocity = at_arm(first, arm_m);
    Pose pose =
        advance(mass_, from, velocity, dt_s, std::max(0.0, left_m) / parameters_.part_radius_m);
    const glm::dvec3 arm_there_m = coupling::grip_arm_m(target, pose);
    pose.position_m -= arm_there_m - arm_m;
    velocity = at_arm(velocity, -arm_there_m);
    const double turn_rad =
        glm::length(coupling::rotation_vector(pose.orientation * glm::conjugate(from.orientation)));
    if (guard::is_within_travel(glm::length(pose.position_m - from.position_m), turn_rad,
                                parameters_.part_radius_m, parameters_.voxel_size_m)) {
      return pose;
    }
  }
  velocity = {};
  return from;
}

// Longest way that any point of the shell can go: its arc is at most the centroid's way and the
// angle times the radius. The centroid's way about the grip is longer than its first velocity says
// by at most half of the arm times the angle squared.
double DefaultModel::travel_m(const Motion& motion, double dt_s) const noexcept {
  const double turn_rad = dt_s * glm::length(coupling::angular_part(motion.velocity));
  return dt_s * glm::length(coupling::linear_part(motion.velocity)) +
         turn_rad * (parameters_.part_radius_m + 0.5 * glm::length(motion.system.arm_m) * turn_rad);
}

double DefaultModel::potential_j(const glm::dvec3& displacement_m, const glm::dvec3& angle_rad,
                                 const LookUp& contacts) const noexcept {
  return coupling::spring_energy_j(translation_, displacement_m) + angle_energy_j(angle_rad) +
         contacts.energy_j;
}

// The rotational half at an angle and an orientation of the part.
coupling::CouplingHalf DefaultModel::rotation_at(const glm::dvec3& angle_rad,
                                                 const glm::dquat& orientation) const noexcept {
  coupling::CouplingHalf rotation = rotation_;
  rotation.damping = turned(rotation_damping_, orientation);
  const double angle = glm::length(angle_rad);
  if (angle > coupling::kFullTorqueRad) {
    rotation.limit = std::min(rotation_.limit, rotation_.stiffness * coupling::kFullTorqueRad);
    rotation.limit *= coupling::torque_fraction(angle);
  }
  return rotation;
}

double DefaultModel::angle_energy_j(const glm::dvec3& angle_rad) const noexcept {
  const double angle = glm::length(angle_rad);
  if (angle <= coupling::kFullTorqueRad) return coupling::spring_energy_j(rotation_, angle_rad);
  const double torque_nm =
      std::min(rotation_.limit, rotation_.stiffness * coupling::kFullTorqueRad);
  return coupling::spring_energy_j(rotation_, angle_rad * (coupling::kFullTorqueRad / angle)) +
         torque_nm * coupling::faded_angle_rad(angle);
}

// The coupling's reaction on the hand at the handle's origin, less the stretch that the hand never
// paid for. The damper goes by the grip's mean velocity over the frame: where the look-ups end
// before the time does, that of the last motion is more than the part went.
Wrench DefaultModel::wrench_on_hand(State& state, const coupling::GripTarget& target,
                                    const Twist& velocity, double dt_s,
                                    StepReport& report) const noexcept {
  const bool entering = state.in_contact == 0;
  state.in_contact = here_.in_free_space() ? 0 : 1;
  if (state.in_contact == 0) return {};
  const Pose& part = state.world_from_center;
  const glm::dvec3 angle = angle_rad(state, target, part);
  const coupling::CouplingHalf rotation = rotation_at(angle, part.orientation);
  // Spring and damper as one stretch: that of the spring alone with the same force.
  const glm::dvec3 stretch_m = coupling::effective_stretch(
      translation_, {coupling::grip_stretch_m(target, part), target.velocity.linear_mps},
      velocity.linear_mps);
  const glm::dvec3 stretch_rad = coupling::effective_stretch(
      rotation, {angle, target.velocity.angular_radps}, velocity.angular_radps);
  if (entering) {
    state.held_back_m = stretch_m;
    state.held_back_rad = stretch_rad;
  }
  const glm::dvec3 force_n =
      clamped(translation_.stiffness * coupling::felt_stretch(stretch_m, state.held_back_m, dt_s),
              translation_.limit);
  const glm::dvec3 torque_nm =
      clamped(rotation.stiffness * coupling::felt_stretch(stretch_rad, state.held_back_rad, dt_s),
              rotation.limit);
  constexpr double kAtLimit = 1 - 1e-12;  // a clamped length is the limit but for rounding
  report.saturated = glm::length(force_n) >= kAtLimit * translation_.limit ||
                     glm::length(torque_nm) >= kAtLimit * rotation_.limit;
  return {-force_n, -torque_nm};
}

}  // namespace forcelayer::model

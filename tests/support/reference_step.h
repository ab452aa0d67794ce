// The paper's model in double precision, by brute force over every point, written from the paper
// and not from runtime/model/paper_model.cpp.
#pragma once

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "forcelayer/parameters.h"
#include "runtime/coupling/state.h"
#include "tests/support/reference_query.h"

namespace forcelayer::test {

struct ReferenceFrame {
  glm::dvec3 velocity_mps, angular_radps;  // after the frame
  Wrench on_hand;
  std::uint32_t interior = 0, surface = 0, proximity = 0, contacts = 0;
  std::vector<TwinPoint> points;  // all
};

// Paper 3 and 5.2: the sum of K_ff d n over the points in value 2, divided by N/10 from 10 on.
inline Wrench reference_field(const Parameters& p, ReferenceFrame& frame) {
  Wrench sum;
  for (const TwinPoint& t : frame.points) {
    frame.interior += t.value == VoxelValue::kInterior;
    frame.proximity += t.value == VoxelValue::kProximity;
    if (t.value != VoxelValue::kSurface) continue;
    ++frame.surface;
    const glm::dvec3 from_point_to_center = (glm::dvec3(0.5) - t.exact_fraction) * p.voxel_size_m;
    const double d = glm::dot(t.exact_normal, from_point_to_center);
    if (d <= 0) continue;
    ++frame.contacts;
    const glm::dvec3 f = p.field_n_per_m * d * t.exact_normal;
    sum.force_n += f;
    sum.torque_nm += glm::cross(t.exact_offset_m, f);
  }
  if (frame.surface >= 10) {
    const double n = frame.surface / 10.0;
    sum.force_n /= n;
    sum.torque_nm /= n;
  }
  return sum;
}

// Paper 5.3 with the degenerate cases at zero.
inline glm::dvec3 reference_braking(const Parameters& p, const ReferenceFrame& frame,
                                    const State& state, double dt_s) {
  glm::dvec3 sum(0);
  for (const TwinPoint& t : frame.points) {
    if (t.value != VoxelValue::kProximity) continue;
    const glm::dvec3 v =
        state.velocity.linear_mps + glm::cross(state.velocity.angular_radps, t.exact_offset_m);
    if (glm::length(v) == 0) continue;
    const double approach = glm::dot(t.exact_normal, glm::normalize(v));
    if (approach < 0) sum += v * -approach;
  }
  if (glm::length(sum) == 0) return glm::dvec3(0);
  const glm::dvec3 v_along =
      glm::normalize(sum) * glm::dot(state.velocity.linear_mps, glm::normalize(sum));
  const double power = glm::dot(v_along, sum);
  if (power <= 0) return glm::dvec3(0);
  const double b = 0.5 * p.mass_kg * glm::dot(v_along, v_along) / dt_s / power;
  return -b * sum;
}

inline ReferenceFrame reference_step(const VoxelScene& scene, const PointPart& part,
                                     const Parameters& p, const State& state,
                                     const StepInput& input, double dt_s) {
  ReferenceFrame frame;
  frame.points = double_twin(scene, part, state.world_from_center);
  Wrench total = reference_field(p, frame);
  if (p.braking) total.force_n += reference_braking(p, frame, state, dt_s);

  const Pose goal = input.world_from_handle * state.handle_from_center;
  glm::dvec3 spring = p.coupling_n_per_m * (goal.position_m - state.world_from_center.position_m);
  const double limit = p.coupling_force_limit_n;
  if (glm::length(spring) > limit) spring = glm::normalize(spring) * limit;
  const glm::dvec3 arm = goal.position_m - input.world_from_handle.position_m;
  const glm::dvec3 goal_velocity =
      input.handle_velocity.linear_mps + glm::cross(input.handle_velocity.angular_radps, arm);
  const glm::dvec3 force =
      spring - p.coupling_ns_per_m * (state.velocity.linear_mps - goal_velocity);
  glm::dquat turn = goal.orientation * glm::inverse(state.world_from_center.orientation);
  if (turn.w < 0) turn = -turn;
  const double angle = glm::angle(turn);
  const glm::dvec3 theta = angle > 0 ? angle * glm::axis(turn) : glm::dvec3(0);
  const glm::dvec3 torque =
      p.coupling_nm_per_rad * theta -
      p.coupling_nms_per_rad * (state.velocity.angular_radps - input.handle_velocity.angular_radps);
  total.force_n += force;
  total.torque_nm += torque;

  const bool free = frame.interior + frame.surface + frame.proximity == 0;
  if (!free) frame.on_hand = {-force, -torque};
  frame.velocity_mps = state.velocity.linear_mps + dt_s / p.mass_kg * total.force_n;
  const double inertia = 0.4 * p.mass_kg * p.part_radius_m * p.part_radius_m;
  frame.angular_radps = state.velocity.angular_radps + dt_s / inertia * total.torque_nm;
  return frame;
}

}  // namespace forcelayer::test

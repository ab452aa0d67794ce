#include "runtime/model/paper_model.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/coupling/coupling.h"

namespace forcelayer::model {
namespace {

constexpr double kAveragingStart = 10;  // paper 5.2: intersections from which forces are averaged

// Sum of the forces of all intersections, averaged from N = 10 on (paper 3, 5.2). About the
// centroid. Reports the contacts, the points of positive depth. Points in value 1 press nothing.
Wrench field_wrench(const StepContext& context, StepReport& report) {
  const query::CollectedPoints& points = context.points;
  const field::FieldSamples& samples = context.samples;
  Wrench sum;
  for (std::uint32_t i = 0; i < points.count; ++i) {
    if (points.value[i] != static_cast<std::uint8_t>(VoxelValue::kSurface)) continue;
    if (!(samples.depth_m[i] > 0)) continue;
    const glm::dvec3 force_n = context.parameters.field_n_per_m * double{samples.depth_m[i]} *
                               glm::dvec3(samples.dx[i], samples.dy[i], samples.dz[i]);
    sum.force_n += force_n;
    sum.torque_nm += glm::cross(glm::dvec3(points.rx[i], points.ry[i], points.rz[i]), force_n);
    ++report.contacts;
    report.depth_m = std::max(report.depth_m, double{samples.depth_m[i]});
  }
  const double intersections = points.surface_count;
  if (intersections >= kAveragingStart) {
    sum.force_n /= intersections / kAveragingStart;
    sum.torque_nm /= intersections / kAveragingStart;
  }
  return sum;
}

// Pre-contact braking (paper 5.3): with S = sum of v_i (-n_i . v^_i) over the approaching points in
// value 3, the force is -b S with b = (m v^2 / 2) / dt / (v . S), v the part's velocity along S.
// Zero where S vanishes (0/0) or v . S is negative (b would push).
glm::dvec3 braking_force(const StepContext& context, const Twist& velocity, double dt_s) {
  const query::CollectedPoints& points = context.points;
  glm::dvec3 sum(0);
  for (std::uint32_t at = 0; at < points.count; ++at) {
    if (points.value[at] != static_cast<std::uint8_t>(VoxelValue::kProximity)) continue;
    const glm::dvec3 arm_m(points.rx[at], points.ry[at], points.rz[at]);
    const glm::dvec3 point_mps = velocity.linear_mps + glm::cross(velocity.angular_radps, arm_m);
    const double speed = glm::length(point_mps);
    const double along =
        glm::dot(glm::dvec3(points.nx[at], points.ny[at], points.nz[at]), point_mps);
    if (along < 0) sum += point_mps * (-along / speed);
  }
  const double length = glm::length(sum);
  if (!(length > 0)) return glm::dvec3(0);
  const glm::dvec3 direction = sum / length;
  const double along_mps = glm::dot(velocity.linear_mps, direction);
  if (!(along_mps > 0)) return glm::dvec3(0);
  // b S = (m v^2 / 2) / dt / (v |S|) * S
  return direction * (-0.5 * context.parameters.mass_kg * along_mps / dt_s);
}

// The coupling's wrench on the part (paper 5.1), the spring's force clamped (5.2).
Wrench coupling_wrench(const Parameters& parameters, const coupling::CouplingStretch& stretch,
                       std::uint32_t& saturated) {
  glm::dvec3 spring_n = parameters.coupling_n_per_m * stretch.displacement_m;
  const double length_n = glm::length(spring_n);
  if (length_n > parameters.coupling_force_limit_n) {
    spring_n *= parameters.coupling_force_limit_n / length_n;
    saturated = 1;
  }
  return {spring_n - parameters.coupling_ns_per_m * stretch.velocity_mps,
          parameters.coupling_nm_per_rad * stretch.rotation_rad -
              parameters.coupling_nms_per_rad * stretch.angular_radps};
}

// The coupling pulls the centroid: handle and part are registered at its center of mass (paper
// 5.1). So its force on the hand acts at the centroid's target, which the handle carries like a
// rigid lever.
Wrench at_handle(const Wrench& on_hand, const coupling::CouplingTarget& target,
                 const StepInput& input) {
  const glm::dvec3 arm_m = target.world_from_center.position_m - input.world_from_handle.position_m;
  return {on_hand.force_n, on_hand.torque_nm + glm::cross(arm_m, on_hand.force_n)};
}

// Symplectic Euler: velocity from the old forces, pose from the new velocity. The inertia is
// isotropic, so there is no gyroscopic term.
void integrate(const Parameters& parameters, const Wrench& wrench, double dt_s, State& state) {
  const double inertia_kgm2 = parameters.inertia_kgm2[0][0];
  state.velocity.linear_mps += wrench.force_n * (dt_s / parameters.mass_kg);
  state.velocity.angular_radps += wrench.torque_nm * (dt_s / inertia_kgm2);
  Pose& part = state.world_from_center;
  part.position_m += state.velocity.linear_mps * dt_s;
  part.orientation =
      glm::normalize(coupling::rotation_by(state.velocity.angular_radps * dt_s) * part.orientation);
}

}  // namespace

StepResult paper_step(const StepContext& context, State& state, const StepInput& input,
                      double dt_s) noexcept {
  const Parameters& parameters = context.parameters;
  StepResult result;
  StepReport& report = result.report;
  context.query.run(state.world_from_center, context.points);
  context.field.measure(context.points, context.samples);
  report.world_from_center = state.world_from_center;
  report.interior = context.points.interior_count;
  report.surface = context.points.surface_count;
  report.proximity = context.points.proximity_count;
  report.outside_map = context.points.outside_map ? 1 : 0;

  Wrench on_part = field_wrench(context, report);
  if (parameters.braking) on_part.force_n += braking_force(context, state.velocity, dt_s);
  const coupling::CouplingTarget target = coupling::coupling_target(state, input);
  const Wrench coupling =
      coupling_wrench(parameters, coupling::coupling_stretch(state, target), report.saturated);
  on_part.force_n += coupling.force_n;
  on_part.torque_nm += coupling.torque_nm;
  if (context.points.count > 0) {
    result.wrench = {-coupling.force_n, -coupling.torque_nm};
    result.at_handle = at_handle(result.wrench, target, input);
  }
  integrate(parameters, on_part, dt_s, state);
  return result;
}

}  // namespace forcelayer::model

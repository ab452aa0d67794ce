#include "runtime/simulation.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "runtime/coupling.h"
#include "runtime/paper_model.h"

namespace forcelayer {
namespace {

constexpr double kUnitTolerance = 1e-6;  // of a quaternion's length: far above rounding

bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

bool finite(const glm::dquat& q) {
  return std::isfinite(q.w) && std::isfinite(q.x) && std::isfinite(q.y) && std::isfinite(q.z);
}

bool finite(const Pose& pose) { return finite(pose.position_m) && finite(pose.orientation); }

bool finite(const Twist& twist) { return finite(twist.linear_mps) && finite(twist.angular_radps); }

bool finite(const Wrench& wrench) { return finite(wrench.force_n) && finite(wrench.torque_nm); }

std::uint32_t input_faults(const StepInput& input) {
  if (input.valid == 0) return kFaultInvalidInput;
  if (!finite(input.world_from_handle) || !finite(input.handle_velocity) ||
      !(std::abs(glm::length(input.world_from_handle.orientation) - 1) < kUnitTolerance)) {
    return kFaultNonFiniteInput;
  }
  return 0;
}

// The part where it was, at rest, and nothing for the hand.
StepResult stopped(State& state, const State& before, std::uint32_t faults) {
  state = before;
  state.velocity = {};
  StepResult result;
  result.report.world_from_center = before.world_from_center;
  result.report.faults = faults;
  result.report.generated_j = before.generated_j + before.episode_peak_j;
  return result;
}

// Energy given to the hand, per contact episode: an episode ends in free space, where the wrench is
// exactly zero, and takes its credit with it.
void observe_energy(State& state, const StepInput& input, double dt_s, StepResult& result) {
  const CouplingTarget target = coupling_target(state, input);
  StepReport& report = result.report;
  report.to_hand_j = dt_s * (glm::dot(result.wrench.force_n, target.velocity.linear_mps) +
                             glm::dot(result.wrench.torque_nm, target.velocity.angular_radps));
  if (report.interior + report.surface + report.proximity == 0) {
    state.generated_j += state.episode_peak_j;
    state.episode_energy_j = state.episode_peak_j = 0;
  }
  state.episode_energy_j += report.to_hand_j;
  state.episode_peak_j = std::max(state.episode_peak_j, state.episode_energy_j);
  report.generated_j = state.generated_j + state.episode_peak_j;
}

}  // namespace

Simulation::Simulation(Voxmap voxmap, Pshell shell, const Parameters& parameters)
    : voxmap_(std::move(voxmap)),
      shell_(std::move(shell)),
      parameters_(parameters),
      query_(voxmap_, shell_) {
  points_.reserve(shell_.view().point_count);
  samples_.reserve(shell_.view().point_count);
}

Result<std::unique_ptr<Simulation>> Simulation::create(Voxmap voxmap, Pshell shell,
                                                       const Parameters& parameters) {
  const double radius_voxels = shell.header().bounding_radius_m / voxmap.voxel_size_m();
  if (!(radius_voxels < ContactQuery::kMaxRadiusVoxels)) {
    return Error{ErrorCode::kFilesDoNotMatch, "", "bounding radius",
                 "the part is more than a million voxels of the scene across",
                 "check the units that scene and part were baked with"};
  }
  std::unique_ptr<Simulation> simulation(
      new Simulation(std::move(voxmap), std::move(shell), parameters));
  auto field = make_force_field(parameters.model, parameters.force, simulation->voxmap_);
  if (!field) return field.error();
  simulation->field_ = std::move(*field);
  if (parameters.model == Model::kDefault) simulation->make_default_model();
  return simulation;
}

void Simulation::make_default_model() {
  probe_ = std::make_unique<FieldProbe>(query_, *field_, points_, samples_);
  default_ = std::make_unique<DefaultModel>(parameters_, *probe_, shell_.view().point_count);
}

Pose Simulation::world_from_part(const Pose& world_from_center) const {
  const auto& c = shell_.header().center_m;
  return world_from_center * Pose{glm::dvec3(-c[0], -c[1], -c[2]), {1, 0, 0, 0}};
}

Pose Simulation::world_from_center(const Pose& world_from_part) const {
  const auto& c = shell_.header().center_m;
  return world_from_part * Pose{glm::dvec3(c[0], c[1], c[2]), {1, 0, 0, 0}};
}

State Simulation::registered(const Pose& world_from_part, const Pose& world_from_handle) const {
  State state;
  state.world_from_center = world_from_center(world_from_part);
  state.handle_from_center = inverse(world_from_handle) * state.world_from_center;
  return state;
}

StepResult Simulation::step(State& state, const StepInput& input, double dt_s) noexcept {
  const State before = state;
  if (const std::uint32_t faults = input_faults(input)) {
    StepResult result = stopped(state, before, faults);
    ++state.frame;
    return result;
  }
  const StepContext context{parameters_, query_, *field_, points_, samples_};
  StepResult result;
  switch (parameters_.model) {
    case Model::kPaper:
      result = paper_step(context, state, input, dt_s);
      break;
    case Model::kDefault:
      result = default_->step(state, input, dt_s);
      break;
  }
  if (!finite(state.world_from_center) || !finite(state.velocity) || !finite(result.wrench)) {
    result = stopped(state, before, kFaultNonFiniteState);
  } else {
    observe_energy(state, input, dt_s, result);
  }
  ++state.frame;
  return result;
}

}  // namespace forcelayer

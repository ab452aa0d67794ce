#include "runtime/model/simulation.h"

#include <string>
#include <system_error>
#include <utility>

#include "runtime/guard/pose_guard.h"
#include "runtime/machine/step_arithmetic.h"
#include "runtime/model/paper_model.h"
#include "runtime/model/vectors.h"

namespace forcelayer::model {
namespace {

constexpr double kUnitTolerance = 1e-6;  // of a quaternion's length: far above rounding

std::uint32_t input_faults(const StepInput& input) {
  if (input.valid != kInputValid && input.valid != kInputClutched) return kFaultInvalidInput;
  if (!is_finite(input.world_from_handle) || !is_finite(input.handle_velocity) ||
      !is_unit(input.world_from_handle.orientation, kUnitTolerance)) {
    return kFaultNonFiniteInput;
  }
  return 0;
}

// A point without an inside can take its direction from stored distances alone.
Status check_sides(const PshellView& shell, const field::ForceField& field) {
  if (shell.two_sided == nullptr || field.proves_distances()) return {};
  const auto count = std::count(shell.two_sided, shell.two_sided + shell.point_count, 1);
  return Error{ErrorCode::kUsage, "", "part",
               std::to_string(count) + " of the part's " + std::to_string(shell.point_count) +
                   " points are on open sheets, which need stored distances",
               "close the open sheets of the part; or bake the scene without --kind lean or paper, "
               "and use --model default --force distance"};
}

// The part where it was, at rest, and nothing for the hand.
StepResult stopped(State& state, const State& before, std::uint32_t faults) {
  state = before;
  state.velocity = {};
  StepResult result;
  result.report.world_from_center = before.world_from_center;
  result.report.seat_open = before.seat != kSeatClosed ? 1 : 0;
  result.report.faults = faults;
  return result;
}

// The part where it was, at rest, and gripped by the hand as it is now. What the models remember of
// the hand and of the contact begins anew.
StepResult regripped(const State& before, const StepInput& input, State& state) {
  state = {};
  state.world_from_center = before.world_from_center;
  state.handle_from_center = inverse(input.world_from_handle) * before.world_from_center;
  state.frame = before.frame;
  state.seat = before.seat;
  StepResult result;
  result.report.world_from_center = before.world_from_center;
  result.report.seat_open = before.seat != kSeatClosed ? 1 : 0;
  return result;
}

}  // namespace

Simulation::Simulation(Voxmap voxmap, Pshell shell, const Parameters& parameters,
                       const query::QueryOptions& query)
    : voxmap_(std::move(voxmap)),
      shell_(std::move(shell)),
      parameters_(parameters),
      query_(voxmap_, shell_, query),
      clearance_(query_) {
  points_.reserve(shell_.view().point_count);
  samples_.reserve(shell_.view().point_count);
}

Simulation::~Simulation() = default;

Result<std::unique_ptr<Simulation>> Simulation::create(Voxmap voxmap, Pshell shell,
                                                       const Parameters& parameters,
                                                       const query::QueryOptions& query) {
  if (Status fits = query::ContactQuery::check_size(voxmap, shell); !fits) return fits.error();
  std::unique_ptr<Simulation> simulation;
  try {
    simulation.reset(new Simulation(std::move(voxmap), std::move(shell), parameters, query));
  } catch (const std::system_error& failure) {
    return Error{ErrorCode::kOutOfMemory, "", "threads",
                 std::to_string(query.threads) + " cannot be started: " + failure.code().message(),
                 "use fewer threads, or raise the limits of threads and memory (ulimit -u, -v)"};
  }
  auto field = field::make_force_field(parameters.model, parameters.force, simulation->voxmap_);
  if (!field) return field.error();
  if (Status sides = check_sides(simulation->shell_.view(), **field); !sides) return sides.error();
  simulation->field_ = std::move(*field);
  if (parameters.model == Model::kDefault) simulation->make_default_model();
  return simulation;
}

void Simulation::make_default_model() {
  guard_ = std::make_unique<guard::PoseGuard>(query_, *field_, points_, samples_);
  make_default_model_of_guard();
}

void Simulation::make_default_model_of_guard() {
  default_ = std::make_unique<DefaultModel>(parameters_, *guard_, shell_.view().point_count,
                                            field::ForceCurve(voxmap_));
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
  state.seat = world_from_seat_ ? kSeatOpen : kSeatClosed;
  state.world_from_center = world_from_center(world_from_part);
  state.handle_from_center = inverse(world_from_handle) * state.world_from_center;
  return state;
}

State Simulation::registered(const PartStart& start, const Pose& world_from_handle) const {
  const Pose held = world_from_handle * start.handle_from_part.value_or(Pose{});
  State state = registered(start.world_from_part.value_or(held), world_from_handle);
  if (start.handle_from_part) state.handle_from_center = world_from_center(*start.handle_from_part);
  return state;
}

Status Simulation::find_seat(const Pose& world_from_center) {
  world_from_seat_.reset();
  if (!guard_) return {};
  const machine::StepArithmetic arithmetic;
  if (Status found = guard_->find_seat(world_from_center); !found) return found;
  make_default_model_of_guard();
  if (!guard_->seat().empty()) world_from_seat_ = world_from_center;
  return {};
}

std::span<const guard::SeatObject> Simulation::seat() const {
  return guard_ ? guard_->seat().objects() : std::span<const guard::SeatObject>{};
}

Result<State> Simulation::begin(const PartStart& start, const Pose& world_from_handle) {
  State state = registered(start, world_from_handle);
  const Pose seat =
      start.world_from_seat ? world_from_center(*start.world_from_seat) : state.world_from_center;
  if (Status found = find_seat(seat); !found) return found.error();
  if (start.world_from_seat && guard_) {
    const machine::StepArithmetic arithmetic;
    if (Status clear = guard_->check_clear(state.world_from_center); !clear) return clear.error();
  }
  state.seat = world_from_seat_ ? kSeatOpen : kSeatClosed;
  return state;
}

StepResult Simulation::step_model(State& state, const StepInput& input, double dt_s) noexcept {
  const StepContext context{parameters_, query_, *field_, points_, samples_};
  if (parameters_.model == Model::kPaper) return paper_step(context, state, input, dt_s);
  StepResult result = default_->step(state, input, dt_s);
  clearance_.prove(result.report.clearance_kind, result.report.clearance_m);
  return result;
}

StepResult Simulation::step(State& state, const StepInput& input, double dt_s) noexcept {
  const machine::StepArithmetic arithmetic;
  const State before = state;
  if (const std::uint32_t faults = input_faults(input)) {
    StepResult result = stopped(state, before, faults);
    ++state.frame;
    return result;
  }
  if (input.valid == kInputClutched) {
    StepResult result = regripped(before, input, state);
    ++state.frame;
    return result;
  }
  StepResult result = step_model(state, input, dt_s);
  if (!is_finite(state.world_from_center) || !is_finite(state.velocity) ||
      !is_finite(result.wrench)) {
    result = stopped(state, before, kFaultNonFiniteState);
  } else {
    state.world_from_handle = input.world_from_handle;
    state.handle_velocity = input.handle_velocity;
    state.has_handle = 1;
  }
  ++state.frame;
  return result;
}

}  // namespace forcelayer::model

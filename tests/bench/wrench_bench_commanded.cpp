#include "tests/bench/wrench_bench_commanded.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <memory>
#include <stdexcept>

#include "forcelayer/run.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/model/simulation.h"
#include "tests/bench/force_bench_frame.h"
#include "tests/stress/trial.h"

namespace forcelayer::bench {
namespace {

using test::VoxelKind;

constexpr double kDtS = 1e-3, kSpeedMps = 0.05, kFarM = 0.02, kPressN = 8;
constexpr int kHeldFrames = 3000;
constexpr double kLeastN = 0.5;  // that a compared part is pressed with
constexpr double kMostOff = 1e-3;

}  // namespace

void Commanded::see(const PairContact& contact, const PairPart& part) {
  RunRequest request;
  request.device = stress::trial_device();
  auto shell = Pshell::from_bytes(part.shell.bytes(), "part");
  if (!shell) throw std::runtime_error(to_line(shell.error()));
  auto run = open_run(contact.bake(VoxelKind::kFull, 0, true), std::move(*shell), request);
  if (!run) throw std::runtime_error(to_line(run.error()));
  const std::unique_ptr<model::Simulation> simulation = run->release_simulation();
  const Parameters& parameters = simulation->parameters();
  const auto field =
      field::make_force_field(Model::kDefault, parameters.force, simulation->voxmap());
  if (!field) throw std::runtime_error(to_line(field.error()));
  ModelFrame frame(simulation->voxmap(), simulation->shell(), **field, Averaging::kShared);

  const std::vector<Pose> line = contact.frames(VoxelKind::kFull);
  const glm::dvec3 in = glm::normalize(line.back().position_m - line.front().position_m);
  Pose above = line.front();
  above.position_m -= kFarM * in;
  const Pose start = simulation->world_from_part(above);
  State state = simulation->registered(start, start);
  loop::HandleVelocity velocity;
  StepInput input;
  input.valid = 1;
  StepResult result;
  double way_m = 0, most_m = 1e300;
  for (int held = 0; held < kHeldFrames && way_m < 4 * kFarM;) {
    if (way_m < most_m) way_m += kSpeedMps * kDtS;
    input.world_from_handle = start;
    input.world_from_handle.position_m += way_m * in;
    input.handle_velocity = velocity.update(input.world_from_handle, kDtS);
    result = simulation->step(state, input, kDtS);
    if (most_m == 1e300 && result.report.contacts > 0) {
      most_m = way_m + kPressN / parameters.coupling_n_per_m;
    }
    if (way_m >= most_m) ++held;
  }
  const double force_n = glm::length(result.wrench.force_n);
  if (result.report.contacts == 0 || force_n < kLeastN) return;
  const Wrench there = frame.at(result.report.world_from_center);
  const double k = parameters.field_n_per_m;
  const double off = glm::length(k * there.force_n - result.wrench.force_n) / force_n;
  const double torque_off = glm::length(k * there.torque_nm - result.wrench.torque_nm) /
                            (force_n * parameters.part_radius_m);
  ++compared_;
  most_ = std::max({most_, off, torque_off});
  if (std::max(off, torque_off) < kMostOff) return;
  throw std::runtime_error("the step commands another wrench than the bench sums");
}

}  // namespace forcelayer::bench

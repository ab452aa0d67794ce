#include "tests/bench/wrench_bench_commanded.h"

#include <algorithm>
#include <glm/geometric.hpp>
#include <memory>
#include <stdexcept>

#include "forcelayer/run.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/model/simulation.h"
#include "tests/bench/wrench_bench_frame.h"
#include "tests/stress/trial.h"

namespace forcelayer::bench {
namespace {

constexpr double kDtS = 1e-3, kSpeedMps = 0.05, kFarM = 0.02;
// So that a single contact is half a voxel deep, and many share the load.
constexpr double kDeviceN = 60, kDeviceNm = 5, kPressN = 40, kDeepVoxels = 0.5;
constexpr int kHeldFrames = 3000;
constexpr double kMinN = 5;  // that a compared part is pressed with

}  // namespace

void Commanded::see(const Voxmap& voxmap, const Pshell& shell, const Pose& above,
                    const glm::dvec3& in) {
  RunRequest request;
  request.device = stress::trial_device();
  request.device.max_force_n = kDeviceN, request.device.max_torque_nm = kDeviceNm;
  request.settings = {{"field_n_per_m", kPressN / (kDeepVoxels * voxmap.voxel_size_m())}};
  request.without_guarantee = true;  // formulas have no covering radius
  auto map = Voxmap::from_bytes(voxmap.bytes(), "scene");
  auto part = Pshell::from_bytes(shell.bytes(), "part");
  if (!map || !part) throw std::runtime_error(to_line(map ? part.error() : map.error()));
  auto run = open_run(std::move(*map), std::move(*part), request);
  if (!run) throw std::runtime_error(to_line(run.error()));
  const std::unique_ptr<model::Simulation> simulation = run->release_simulation();
  const Parameters& parameters = simulation->parameters();
  const auto field =
      field::make_force_field(Model::kDefault, parameters.force, simulation->voxmap());
  if (!field) throw std::runtime_error(to_line(field.error()));
  ModelFrame frame(simulation->voxmap(), simulation->shell(), **field, Averaging::kShared);

  Pose far = above;
  far.position_m -= kFarM * in;
  const Pose start = simulation->world_from_part(far);
  State state = simulation->registered(start, start);
  loop::HandleVelocity velocity;
  StepInput input;
  input.valid = 1;
  StepResult result;
  double way_m = 0, max_m = 1e300;
  for (int held = 0; held < kHeldFrames && way_m < 4 * kFarM;) {
    if (way_m < max_m) way_m += kSpeedMps * kDtS;
    input.world_from_handle = start;
    input.world_from_handle.position_m += way_m * in;
    input.handle_velocity = velocity.update(input.world_from_handle, kDtS);
    result = simulation->step(state, input, kDtS);
    if (max_m == 1e300 && result.report.contacts > 0) {
      max_m = way_m + kPressN / parameters.coupling_n_per_m;
    }
    if (way_m >= max_m) ++held;
  }
  const double force_n = glm::length(result.wrench.force_n);
  if (state.settled == 0 || result.report.contacts == 0 || force_n < kMinN) return;
  const Wrench there = frame.at(result.report.world_from_center);
  const double k = parameters.field_n_per_m;
  const double off = glm::length(k * there.force_n - result.wrench.force_n) / force_n;
  const double torque_off = glm::length(k * there.torque_nm - result.wrench.torque_nm) /
                            (force_n * parameters.part_radius_m);
  off_.push_back(std::max(off, torque_off));
  many_ += result.report.contacts > 10;
}

}  // namespace forcelayer::bench

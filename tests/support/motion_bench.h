// A simulation with its state and a handle that a test moves: for tests of motion.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>

#include "forcelayer/run.h"
#include "runtime/coupling/coupling.h"
#include "runtime/model/simulation.h"
#include "tests/support/random_numbers.h"
#include "tests/support/shape_scene.h"

namespace forcelayer::test {

// The device that the paper was run with (6.4), with the damping and delay of such devices.
inline DeviceCapabilities paper_device() {
  DeviceCapabilities device;
  device.name = "test";
  device.max_force_n = 15;
  device.max_torque_nm = 0.1;
  device.damping_ns_per_m = 2;
  device.damping_nms_per_rad = 0.005;
  device.delay_s = 0.001;
  return device;
}

struct BenchOptions {
  Model model = Model::kDefault;
  double rate_hz = 1000;
  bool braking = true;
  std::map<std::string, double> settings;
  std::map<std::string, double> beyond =
      {};  // parameters out of a setting's range, put in place later
};

class MotionBench {
 public:
  MotionBench(const VoxelScene& scene, const PointPart& part, const Pose& start,
              const BenchOptions& options = {}) {
    RunRequest request;
    request.model = options.model;
    request.rate_hz = options.rate_hz;
    request.braking = options.braking;
    request.settings = options.settings;
    request.device = paper_device();
    request.without_guarantee = true;  // any part will do
    auto run = open_run(make_voxmap(scene), make_pshell(part), request);
    if (run && !options.beyond.empty()) {
      request.recorded = run->parameters();
      for (const ParameterInfo& info : parameter_table()) {
        const auto at = options.beyond.find(std::string(info.name));
        if (at != options.beyond.end()) (*request.recorded).*(info.member) = at->second;
      }
      run = open_run(make_voxmap(scene), make_pshell(part), request);
    }
    if (!run) throw std::runtime_error(to_line(run.error()));
    simulation = run->release_simulation();
    dt_s = 1 / options.rate_hz;
    state = simulation->registered(start, start);
    input.valid = 1;
    input.world_from_handle = start;
  }

  // One frame with the handle at `pose`; its velocity is that from the frame before.
  StepResult step_to(const Pose& pose) {
    const Pose& last = input.world_from_handle;
    input.handle_velocity = {
        (pose.position_m - last.position_m) / dt_s,
        coupling::rotation_vector(pose.orientation * glm::conjugate(last.orientation)) / dt_s};
    input.world_from_handle = pose;
    return simulation->step(state, input, dt_s);
  }

  // One frame with the handle where it is, at rest.
  StepResult hold() { return step_to(input.world_from_handle); }

  const Pose& handle() const { return input.world_from_handle; }
  const Pose& part() const { return state.world_from_center; }
  const Parameters& parameters() const { return simulation->parameters(); }

  std::unique_ptr<model::Simulation> simulation;
  State state;
  StepInput input;
  double dt_s = 0.001;
};

}  // namespace forcelayer::test

// A part in the whole closed loop: a simulated device, with a hand on it or moved by a test, holds
// the part by a grip anywhere on it, and the servo stands between as it does before hardware.
#pragma once

#include <algorithm>
#include <functional>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

#include "forcelayer/run.h"
#include "runtime/coupling/coupling.h"
#include "runtime/devices/sim_device.h"
#include "runtime/loop/servo.h"
#include "runtime/model/simulation.h"
#include "tests/support/distance_scene.h"
#include "tests/support/random_numbers.h"
#include "tests/support/shape_scene.h"

namespace forcelayer::test {

// A handle that a test moves, or a hand on it that wants to go where the test says.
class HandleDevice final : public devices::Device {
 public:
  HandleDevice(const DeviceCapabilities& capabilities,
               const std::optional<devices::SimHandParameters>& hand, const Pose& start)
      : wanted(start), capabilities_(capabilities), pose_(start) {
    if (!hand) return;
    parameters_ = *hand;
    hand_.emplace(*hand, start);
  }

  const DeviceCapabilities& capabilities() const override { return capabilities_; }
  Status start() override { return {}; }
  DeviceSample read(double time_s) noexcept override {
    const double passed_s = time_s - time_s_;
    time_s_ = time_s;
    if (!hand_) {
      pose_ = wanted;
    } else if (passed_s > 0) {
      pose_ = hand_->step(wanted, output, passed_s);
    }
    DeviceSample sample;
    sample.device_from_handle = pose_;
    sample.fresh = sample.present = true;
    return sample;
  }
  void write(const Wrench& device_wrench) noexcept override { output = device_wrench; }
  void stop() noexcept override { output = {}; }

  // The hand lets go: the handle stays on the device alone.
  void let_go() {
    if (!hand_) return;
    parameters_.hand_mass_kg = parameters_.hand_damping_ns_per_m = 0;
    parameters_.hand_inertia_kgm2 = parameters_.hand_damping_nms_per_rad = 0;
    parameters_.hand_force_n = parameters_.hand_torque_nm = 0;
    hand_.emplace(parameters_, hand_->pose());
  }

  // The pose of the handle itself, between the encoder's steps.
  const Pose& pose() const { return hand_ ? hand_->pose() : pose_; }

  Pose wanted;    // device axes
  Wrench output;  // that the motors have

 private:
  DeviceCapabilities capabilities_;
  devices::SimHandParameters parameters_;
  std::optional<devices::SimHand> hand_;
  Pose pose_;
  double time_s_ = 0;
};

// Work at the device's port, counted from what the motors had and where the handle was, and what a
// sampled spring of `stiffness` must give of it at least: k T / 2 times the integral of v^2.
class PortWork {
 public:
  void see(const Pose& handle, const Wrench& motors, double dt_s) {
    if (known_) {
      const glm::dvec3 way_m = handle.position_m - last_.position_m;
      const glm::dvec3 turn =
          coupling::rotation_vector(handle.orientation * glm::conjugate(last_.orientation));
      given_j += glm::dot(held_.force_n, way_m) + glm::dot(held_.torque_nm, turn);
      speed2_s += glm::dot(way_m, way_m) / dt_s;
      turning2_s += glm::dot(turn, turn) / dt_s;
      moved_j +=
          std::abs(glm::dot(held_.force_n, way_m)) + std::abs(glm::dot(held_.torque_nm, turn));
    }
    last_ = handle;
    held_ = motors;
    known_ = true;
  }

  double given_j = 0;     // to the hand
  double moved_j = 0;     // either way
  double speed2_s = 0;    // integral of v^2, m^2/s
  double turning2_s = 0;  // of w^2, rad^2/s

 private:
  Pose last_;
  Wrench held_;
  bool known_ = false;
};

struct HeldPartOptions {
  Model model = Model::kDefault;
  double motion_scale = 1;
  std::map<std::string, double> settings;
  std::optional<devices::SimHandParameters> hand;  // none: the handle is where the test has it
  Pose start;                                      // world_from_part, gripped there without stretch
  Pose part_from_handle;                           // the grip
  bool seated = false;  // installed where it starts (runtime/field/README.md, "Seats")
};

class HeldPart {
 public:
  HeldPart(const VoxelScene& scene, const PointPart& part, const HeldPartOptions& options)
      : start_handle_(options.start * options.part_from_handle),
        run_(opened(scene, part, options)),
        placement_(placed(options)),
        device_(capabilities(options), options.hand, placement_.device_from_handle(start_handle_)),
        input_(device_, placement_),
        servo_(run_.simulation(), input_, begun(run_.simulation(), options, start_handle_),
               limits(run_.parameters())) {}

  // One period. `wanted`: where test or hand have the handle, device axes.
  const Frame& tick(const Pose& wanted) {
    device_.wanted = wanted;
    if (!servo_.tick(frame_)) throw std::runtime_error("the input ended");
    work_.see(placement_.device_from_handle(frame_.input.world_from_handle), frame_.device_wrench,
              servo_.dt_s());
    return frame_;
  }
  const Frame& tick() { return tick(device_.wanted); }

  Pose start_handle() const { return placement_.device_from_handle(start_handle_); }  // device axes
  HandleDevice& device() { return device_; }
  loop::Servo& servo() { return servo_; }
  const DevicePlacement& placement() const { return placement_; }
  const Parameters& parameters() const { return run_.parameters(); }
  const std::vector<std::string>& warnings() const { return run_.warnings(); }
  const Frame& frame() const { return frame_; }
  PortWork& work() { return work_; }  // since the start, or since it was set to {}

 private:
  static DeviceCapabilities capabilities(const HeldPartOptions& options) {
    DeviceCapabilities device =
        devices::hand_capabilities(options.hand.value_or(devices::SimHandParameters{}));
    if (!options.hand) device.encoder_step_m = device.encoder_step_rad = 0;
    return device;
  }
  static DevicePlacement placed(const HeldPartOptions& options) {
    DevicePlacement placement;
    placement.motion_scale = options.motion_scale;
    // The device's origin is where the handle starts.
    placement.world_from_device.position_m = (options.start * options.part_from_handle).position_m;
    return placement;
  }
  static Run opened(const VoxelScene& scene, const PointPart& part,
                    const HeldPartOptions& options) {
    RunRequest request;
    request.model = options.model;
    request.settings = options.settings;
    request.device = capabilities(options);
    request.placement = placed(options);
    request.without_guarantee = true;  // any part will do
    auto run = open_run(make_voxmap(scene), make_pshell(part), request);
    if (!run) throw std::runtime_error(to_line(run.error()));
    return std::move(*run);
  }
  static State begun(model::Simulation& simulation, const HeldPartOptions& options,
                     const Pose& start_handle) {
    if (!options.seated) return simulation.registered(options.start, start_handle);
    PartStart start;
    start.world_from_part = options.start;
    const auto state = simulation.begin(start, start_handle);
    if (!state) throw std::runtime_error(to_line(state.error()));
    return *state;
  }
  static loop::OutputLimits limits(const Parameters& parameters) {
    loop::OutputLimits limits;
    limits.max_force_n = parameters.max_force_n;
    limits.max_torque_nm = parameters.max_torque_nm;
    return limits;
  }

  Pose start_handle_;  // world
  Run run_;
  DevicePlacement placement_;
  HandleDevice device_;
  loop::DeviceInput input_;
  loop::Servo servo_;
  Frame frame_;
  PortWork work_;
};

}  // namespace forcelayer::test

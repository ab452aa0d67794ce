#include "runtime/loop/servo.h"

#include <glm/geometric.hpp>
#include <utility>

#include "runtime/coupling/coupling.h"
#include "runtime/machine/real_time.h"
#include "runtime/machine/step_arithmetic.h"
#include "runtime/model/outcome_hash.h"

namespace forcelayer::loop {
namespace {

// A stretch below these, at the device, counts as zero: four encoder steps (25 um, 0.013 degrees),
// which a still hand moves a handle between registration and a frame. The springs' pull at such a
// stretch is below a twentieth of the device's rating, and the ramp lets it in.
constexpr double kNoStretchM = 1e-4;
constexpr double kNoStretchRad = 1e-3;

}  // namespace

Servo::Servo(model::Simulation& simulation, InputSource& input, const State& start,
             const OutputLimits& limits)
    : simulation_(&simulation),
      input_(input),
      state_(start),
      output_(limits),
      dt_s_(1 / simulation.parameters().rate_hz) {}

bool Servo::request_swap(model::Simulation& next, const PartStart& start) noexcept {
  if (swapping() || 1 / next.parameters().rate_hz != dt_s_) return false;
  next_start_ = start;
  next_.store(&next, std::memory_order_release);
  return true;
}

void Servo::take_health(const StepInput& input, InputHealth& health) noexcept {
  health = input_.health();
  health.loop_late |= std::exchange(late_, false);
  health.clutch |=
      clutch_.load(std::memory_order_relaxed) || (input.buttons & clutch_buttons_) != 0;
  health.swapping |= swapping() || held_.load(std::memory_order_relaxed);
}

void Servo::take_swap(const StepInput& input) noexcept {
  model::Simulation* const next = next_.load(std::memory_order_acquire);
  if (next == nullptr || helped_) return;
  const std::uint64_t frame = state_.frame;
  state_ = next->registered(next_start_, input.world_from_handle);
  state_.frame = frame;
  ++scene_;
  objects_before_ += simulation_->voxmap().header().object_count;
  simulation_ = next;
  next_.store(nullptr, std::memory_order_release);
}

// The step's wrench and the passivity controller's at the device, and the work that went through
// the device's port until now.
Wrench Servo::wanted_at_device(Frame& frame, bool free_of_contact) noexcept {
  const DevicePlacement& placement = input_.placement();
  Wrench wanted = placement.device_wrench(frame.result.at_handle);
  constexpr std::uint32_t kNoPose = kFaultInvalidInput | kFaultNonFiniteInput;
  if ((frame.result.report.faults & kNoPose) != 0) {
    port_.lose_handle();
  } else {
    port_.arrive(placement.device_from_handle(frame.input.world_from_handle), !free_of_contact);
    const Parameters& p = simulation_->parameters();
    const Wrench damper = port_.damping(placement.device_twist(frame.input.handle_velocity),
                                        p.part_radius_m / placement.motion_scale,
                                        p.passivity_damping_ns_per_m, dt_s_);
    wanted.force_n += damper.force_n;
    wanted.torque_nm += damper.torque_nm;
  }
  frame.to_hand_j = port_.to_hand_j();
  frame.generated_j = port_.generated_j();
  return wanted;
}

// A wrench at the device with the guide's on top.
Wrench Servo::guided(const Frame& frame, const Wrench& at_device) noexcept {
  const bool pressed = (frame.input.buttons & guide_buttons_) != 0;
  if (pressed && !guide_pressed_) guide_wanted_ = !guide_wanted_;
  guide_pressed_ = pressed;
  const glm::dquat& world_from_device = input_.placement().world_from_device.orientation;
  GuideFrame guide;
  guide.world_from_handle = frame.input.world_from_handle;
  guide.handle_from_center = state_.handle_from_center;
  guide.contact = {world_from_device * at_device.force_n, world_from_device * at_device.torque_nm};
  guide.max_force_n = output_.limits().max_force_n;
  guide.max_torque_nm = output_.limits().max_torque_nm;
  constexpr std::uint32_t kNoPose = kFaultInvalidInput | kFaultNonFiniteInput;
  guide.placed = (frame.result.report.faults & kNoPose) == 0;
  guide.sound = frame.result.report.faults == 0 && !frame.health.clutch && !frame.health.swapping &&
                output_.gate().armed();
  guide.wanted = guide_wanted_;
  const Wrench pull = guide_->pull(guide, dt_s_);
  const glm::dquat device_from_world = glm::conjugate(world_from_device);
  return {at_device.force_n + device_from_world * pull.force_n,
          at_device.torque_nm + device_from_world * pull.torque_nm};
}

// The device's wrench goes out, the guide's share in it, whose work is the guide's own matter.
void Servo::leave(Frame& frame) noexcept {
  Wrench rest = frame.device_wrench;
  if (guide_ != nullptr) {
    guide_->leave(output_.gate().gain());
    const glm::dquat device_from_world =
        glm::conjugate(input_.placement().world_from_device.orientation);
    const Wrench& guide = guide_->left();
    rest.force_n -= device_from_world * guide.force_n;
    rest.torque_nm -= device_from_world * guide.torque_nm;
    frame.guide_force_n = glm::length(guide.force_n);
    frame.guide_torque_nm = glm::length(guide.torque_nm);
    frame.guide_given_j = guide_->given_j();
    frame.guide_allowed_j = guide_->allowed_j();
  }
  port_.leave(rest);
}

OutputFrame Servo::output_frame(Frame& frame) noexcept {
  const StepReport& report = frame.result.report;
  const StepInput& input = frame.input;
  const coupling::GripTarget target = coupling::grip_target(state_, input);
  OutputFrame out;
  out.health = frame.health;
  out.faulty = report.faults != 0;
  out.not_finite = (report.faults & (kFaultNonFiniteInput | kFaultNonFiniteState)) != 0;
  out.speed_mps = glm::length(input.handle_velocity.linear_mps) / input_.placement().motion_scale;
  out.turn_radps = glm::length(input.handle_velocity.angular_radps);
  out.free_of_contact = report.interior + report.surface + report.proximity == 0;
  const glm::dvec3 gap_m = coupling::grip_stretch_m(target, report.world_from_center);
  const glm::dvec3 turn_rad = coupling::rotation_vector(
      target.orientation * glm::conjugate(report.world_from_center.orientation));
  out.unstretched = glm::length(gap_m) < kNoStretchM * input_.placement().motion_scale &&
                    glm::length(turn_rad) < kNoStretchRad;
  out.wanted = wanted_at_device(frame, out.free_of_contact);
  if (guide_ != nullptr) {
    out.wanted = guided(frame, out.wanted);
    frame.to_hand_j += guide_->work_j();
  }
  return out;
}

bool Servo::tick(Frame& frame) noexcept {
  const machine::StepArithmetic arithmetic;
  frame.number = state_.frame;
  frame.time_s = static_cast<double>(state_.frame) * dt_s_;
  if (!input_.next(frame.time_s, dt_s_, frame.input)) return false;
  take_health(frame.input, frame.health);
  const bool regrip = frame.health.clutch || frame.health.swapping;
  if (regrip && output_.at_zero() && frame.input.valid == kInputValid) {
    take_swap(frame.input);
    frame.input.valid = kInputClutched;
  }
  frame.scene = scene_;
  frame.objects_before = objects_before_;
  const std::int64_t begin_ns = machine::monotonic_ns();
  frame.result = simulation_->step(state_, frame.input, dt_s_);
  frame.step_ns = machine::monotonic_ns() - begin_ns;
  frame.device_wrench = output_.pass(output_frame(frame), dt_s_);
  leave(frame);
  frame.output = output_.state();
  frame.world_from_target = coupling::coupling_target(state_, frame.input).world_from_center;
  frame.last_trip = output_.last_trip();
  frame.outcome_hash = model::outcome_hash(frame.result, state_);
  input_.output(frame);
  return true;
}

}  // namespace forcelayer::loop

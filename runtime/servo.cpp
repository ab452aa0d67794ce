#include "runtime/servo.h"

#include <time.h>

#include <glm/geometric.hpp>

#include "runtime/coupling.h"
#include "runtime/outcome_hash.h"

namespace forcelayer {
namespace {

// A stretch below these is rounding: registered poses reproduce to 1e-15 of the scene's extent.
constexpr double kNoStretchM = 1e-9;
constexpr double kNoStretchRad = 1e-9;

std::int64_t now_ns() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

}  // namespace

Servo::Servo(Simulation& simulation, InputSource& input, const State& start,
             const OutputLimits& limits)
    : simulation_(simulation),
      input_(input),
      state_(start),
      output_(limits),
      dt_s_(1 / simulation.parameters().rate_hz) {}

OutputFrame Servo::output_frame(const StepInput& input, const StepResult& result) const noexcept {
  const StepReport& report = result.report;
  const DevicePlacement& placement = input_.placement();
  const CouplingTarget target = coupling_target(state_, input);
  OutputFrame frame;
  frame.faulty = report.faults != 0;
  frame.speed_mps = glm::length(input.handle_velocity.linear_mps) / placement.motion_scale;
  frame.free_of_contact = report.interior + report.surface + report.proximity == 0;
  const glm::dvec3 gap_m =
      target.world_from_center.position_m - report.world_from_center.position_m;
  const glm::dvec3 turn_rad = rotation_vector(target.world_from_center.orientation *
                                              glm::conjugate(report.world_from_center.orientation));
  frame.unstretched = glm::length(gap_m) < kNoStretchM && glm::length(turn_rad) < kNoStretchRad;
  // The coupling holds the hand at its target: there the force acts, so that the power at the
  // handle is that of the coupling.
  frame.wanted = placement.device_wrench(result.wrench, target.world_from_center.position_m,
                                         input.world_from_handle.position_m);
  return frame;
}

bool Servo::tick(Frame& frame) noexcept {
  frame.number = state_.frame;
  frame.time_s = static_cast<double>(state_.frame) * dt_s_;
  if (!input_.next(frame.time_s, dt_s_, frame.input)) return false;
  const std::int64_t begin_ns = now_ns();
  frame.result = simulation_.step(state_, frame.input, dt_s_);
  frame.step_ns = now_ns() - begin_ns;
  frame.device_wrench = output_.pass(output_frame(frame.input, frame.result), dt_s_);
  frame.output = output_.state();
  frame.world_from_target = coupling_target(state_, frame.input).world_from_center;
  frame.outcome_hash = outcome_hash(frame.result, state_);
  input_.output(frame);
  return true;
}

}  // namespace forcelayer

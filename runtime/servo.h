// One tick of the servo: input in, step, output out. The library's entry for anyone's own loop:
// call tick() at a constant rate from one thread.
#pragma once

#include "runtime/frame.h"
#include "runtime/input_source.h"
#include "runtime/output_stage.h"
#include "runtime/simulation.h"

namespace forcelayer {

class Servo {
 public:
  // Everything given must outlive the servo. `start` is the state before the first tick.
  Servo(Simulation& simulation, InputSource& input, const State& start, const OutputLimits& limits);

  // Reads, steps and writes once. Never blocks, allocates, locks or logs (the device's own calls
  // apart). Fills `frame`; false at the input's end.
  bool tick(Frame& frame) noexcept;

  // Around a tick in which the query's helper threads should take part; both call the system, so
  // they are not in tick() itself. wants_helpers(): whether the last tick looked at enough points.
  bool wants_helpers() const noexcept {
    return simulation_.query().points_looked_at() > kPointsWorthHelp;
  }
  void wake_helpers() noexcept { simulation_.wake_helpers(); }
  void rest_helpers() noexcept { simulation_.rest_helpers(); }

  // Zero to the device, at the end or whenever the caller must fail.
  void silence() noexcept { input_.silence(); }

  const State& state() const { return state_; }
  const OutputStage& output() const { return output_; }
  double dt_s() const { return dt_s_; }

 private:
  static constexpr std::uint64_t kPointsWorthHelp = 16384;  // some 40 us of one core

  OutputFrame output_frame(const StepInput& input, const StepResult& result) const noexcept;

  Simulation& simulation_;
  InputSource& input_;
  State state_;
  OutputStage output_;
  double dt_s_;
};

}  // namespace forcelayer

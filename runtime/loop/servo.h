// One tick of the servo: input in, step, output out. The library's entry for anyone's own loop:
// call tick() at a constant rate from one thread.
#pragma once

#include <atomic>

#include "forcelayer/frame.h"
#include "runtime/loop/device_port.h"
#include "runtime/loop/guide.h"
#include "runtime/loop/input_source.h"
#include "runtime/loop/output_stage.h"
#include "runtime/model/simulation.h"

namespace forcelayer::loop {

class Servo {
 public:
  // Everything given must outlive the servo. `start` is the state before the first tick.
  Servo(model::Simulation& simulation, InputSource& input, const State& start,
        const OutputLimits& limits);

  // Reads, steps and writes once. Never blocks, allocates, locks or logs (the device's own calls
  // apart). Fills `frame`; false at the input's end.
  bool tick(Frame& frame) noexcept;

  // Device buttons, a bit each; any of them is the clutch. Before the first tick.
  void set_clutch_buttons(std::uint32_t buttons) { clutch_buttons_ = buttons; }

  // A path that leads the hand, and the device buttons that switch it off and on again. Before the
  // first tick; it must outlive the servo.
  void set_guide(Guide* guide, std::uint32_t buttons) {
    guide_ = guide;
    guide_buttons_ = buttons;
  }

  // The clutch, from any thread, beside the buttons. While it is pressed, the output fades to zero;
  // then the part stays where it is, in contact or not, and the hand goes anywhere. When it is
  // released, the hand holds the part as it is, without stretch, and the output ramps in. The
  // clutch also arms a tripped output.
  void set_clutch(bool pressed) noexcept { clutch_.store(pressed, std::memory_order_relaxed); }

  // Holds the part as the clutch does, from any thread, but arms nothing: to see where the part is
  // before a swap.
  void set_hold(bool held) noexcept { held_.store(held, std::memory_order_relaxed); }

  // Swaps part or scene without a restart, from any thread. The output fades to zero; the next tick
  // goes on with `next` and its part where `start` puts it, gripped without stretch (the place
  // counts where `start` has a grip too); then the output ramps in. `next` must outlive the servo
  // or the next swap. The old simulation is free once swapping() is false. Returns false where a
  // swap is under way or the rate differs.
  bool request_swap(model::Simulation& next, const PartStart& start) noexcept;
  bool swapping() const noexcept { return next_.load(std::memory_order_acquire) != nullptr; }

  // Called before a tick that begins later than the stale limit allows. The output trips in that
  // tick, because the device's side has let go by now.
  void note_late() noexcept { late_ = true; }

  // Wake and rest the query's helper threads around a tick. Both call the system, so tick() does
  // not do it. wants_helpers(): whether the last tick looked at enough points to need them.
  bool wants_helpers() const noexcept {
    return !swapping() && simulation_->query().points_looked_at() >= query::kPointsWorthSharing;
  }
  void wake_helpers() noexcept {
    helped_ = true;
    simulation_->wake_helpers();
  }
  void rest_helpers() noexcept {
    simulation_->rest_helpers();
    helped_ = false;
  }

  // Zero to the device, at the end or whenever the caller must fail.
  void silence() noexcept { input_.silence(); }

  const model::Simulation& simulation() const { return *simulation_; }
  const State& state() const { return state_; }
  const OutputStage& output() const { return output_; }
  double dt_s() const { return dt_s_; }
  std::uint32_t objects_before() const { return objects_before_; }  // Frame::objects_before

 private:
  void take_health(const StepInput& input, InputHealth& health) noexcept;
  void take_swap(const StepInput& input) noexcept;
  OutputFrame output_frame(Frame& frame) noexcept;
  Wrench wanted_at_device(Frame& frame, bool free_of_contact) noexcept;
  Wrench guided(const Frame& frame, const Wrench& at_device) noexcept;
  void leave(Frame& frame) noexcept;

  model::Simulation* simulation_;
  InputSource& input_;
  State state_;
  OutputStage output_;
  DevicePort port_;
  double dt_s_;
  std::uint32_t clutch_buttons_ = 0;
  Guide* guide_ = nullptr;
  std::uint32_t guide_buttons_ = 0;
  bool guide_pressed_ = false, guide_wanted_ = true;
  bool late_ = false;
  bool helped_ = false;  // the helpers are awake: no swap in this tick
  std::atomic<bool> clutch_{false}, held_{false};
  std::uint32_t scene_ = 0, objects_before_ = 0;   // Frame::scene, Frame::objects_before
  std::atomic<model::Simulation*> next_{nullptr};  // to be swapped in, at next_start_
  PartStart next_start_;                           // of its part; written before next_
};

}  // namespace forcelayer::loop

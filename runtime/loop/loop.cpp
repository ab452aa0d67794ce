#include "runtime/loop/loop.h"

#include <sched.h>

#include "runtime/machine/real_time.h"

namespace forcelayer::loop {
namespace {

void hand_over(const Frame& frame, bool may_wait, machine::SpscRing<Frame>& ring,
               LoopStatistics& s) noexcept {
  while (!ring.push(frame)) {
    if (!may_wait) {
      ++s.dropped_frames;
      return;
    }
    sched_yield();
  }
}

// The clock of the ticks. Ticks that passed are skipped, never made up for in a burst.
class Pacer {
 public:
  explicit Pacer(double dt_s)
      : period_ns_(static_cast<long long>(dt_s * 1e9 + 0.5)), tick_ns_(machine::monotonic_ns()) {}

  // Sleeps until the next tick, and gives its time.
  long long wait_for_tick(LoopStatistics& s) noexcept {
    tick_ns_ += period_ns_;
    const long long late_ns = machine::monotonic_ns() - tick_ns_;
    if (late_ns > 0) {
      const long long passed = late_ns / period_ns_;
      tick_ns_ += passed * period_ns_;
      s.skipped_ticks += static_cast<std::uint64_t>(passed);
    }
    machine::sleep_until_ns(tick_ns_);
    return tick_ns_;
  }

  long long period_ns() const { return period_ns_; }

 private:
  long long period_ns_;
  long long tick_ns_;  // time of the current tick
};

// Runs ticks; with a clock, measures the cost of each.
class Runner {
 public:
  Runner(Servo& servo, const LoopOptions& options, LoopStatistics& statistics)
      : servo_(servo), options_(options), statistics_(statistics), pacer_(servo.dt_s()) {}

  bool tick(Frame& frame) noexcept {
    if (options_.as_fast_as_possible) {
      if (!tick_with_helpers(frame)) return false;
      statistics_.count(frame);
      return true;
    }
    meter_.woke(pacer_.wait_for_tick(statistics_));
    notice_lateness();
    if (!tick_with_helpers(frame)) return false;
    statistics_.count(frame, meter_.end(), pacer_.period_ns());
    return true;
  }

  bool at_end() const noexcept { return options_.end_on_trip && servo_.output().trips() > 0; }

 private:
  // Tells the servo when the device has heard nothing for a period and the stale limit.
  void notice_lateness() noexcept {
    const long long now_ns = machine::monotonic_ns();
    const long long since_ns = now_ns - last_ns_ - pacer_.period_ns();
    if (last_ns_ != 0 && static_cast<double>(since_ns) > options_.stale_s * 1e9) servo_.note_late();
    last_ns_ = now_ns;
  }

  bool tick_with_helpers(Frame& frame) noexcept {
    const bool helped = servo_.wants_helpers();
    if (helped) servo_.wake_helpers();
    const bool ticked = servo_.tick(frame);
    if (helped) servo_.rest_helpers();
    return ticked;
  }

  Servo& servo_;
  const LoopOptions& options_;
  LoopStatistics& statistics_;
  Pacer pacer_;
  TickMeter meter_;
  long long last_ns_ = 0;  // when the last tick began
};

}  // namespace

void run_loop(Servo& servo, const LoopOptions& options, machine::SpscRing<Frame>* ring,
              LoopStatistics& statistics) noexcept {
  Frame frame;
  Runner runner(servo, options, statistics);
  for (std::uint64_t n = 0; !options.frames || n < *options.frames; ++n) {
    if (options.stop != nullptr && options.stop->load(std::memory_order_relaxed) != 0) break;
    if (!runner.tick(frame)) break;
    if (ring != nullptr) hand_over(frame, options.as_fast_as_possible, *ring, statistics);
    if (runner.at_end()) break;
  }
  servo.silence();
}

}  // namespace forcelayer::loop

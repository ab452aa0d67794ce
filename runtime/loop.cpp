#include "runtime/loop.h"

#include <sched.h>

#include <algorithm>
#include <glm/geometric.hpp>

#include "runtime/real_time.h"

namespace forcelayer {
namespace {

void count(const Frame& frame, LoopStatistics& s) noexcept {
  const StepReport& report = frame.result.report;
  ++s.frames;
  s.force_layer_frames += report.surface + report.interior > 0;
  s.penetration_frames += report.interior > 0;
  s.contact_frames += report.contacts > 0;
  s.guard_cuts += report.guard_cuts;
  s.outside_map_frames += report.outside_map;
  s.saturated_frames += report.saturated;
  s.faulty_frames += report.faults != 0;
  s.outcome_hash = (s.outcome_hash ^ frame.outcome_hash) * 0x100000001b3u;
  s.max_force_n = std::max(s.max_force_n, glm::length(frame.result.wrench.force_n));
  s.max_torque_nm = std::max(s.max_torque_nm, glm::length(frame.result.wrench.torque_nm));
  s.max_device_force_n = std::max(s.max_device_force_n, glm::length(frame.device_wrench.force_n));
  s.max_device_torque_nm =
      std::max(s.max_device_torque_nm, glm::length(frame.device_wrench.torque_nm));
  s.generated_j = report.generated_j;
  s.step.record(frame.step_ns);
}

void hand_over(const Frame& frame, bool may_wait, SpscRing<Frame>& ring,
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
      : period_ns_(static_cast<long long>(dt_s * 1e9 + 0.5)), tick_ns_(monotonic_ns()) {}

  void wait_for_tick(LoopStatistics& s) noexcept {
    tick_ns_ += period_ns_;
    const long long late_ns = monotonic_ns() - tick_ns_;
    if (late_ns > 0) {
      const long long passed = late_ns / period_ns_;
      tick_ns_ += passed * period_ns_;
      s.skipped_ticks += static_cast<std::uint64_t>(passed);
    }
    sleep_until_ns(tick_ns_);
    s.wakeup.record(monotonic_ns() - tick_ns_);
  }

  void frame_done(LoopStatistics& s) const noexcept {
    s.deadline_misses += monotonic_ns() - tick_ns_ > period_ns_;
  }

 private:
  long long period_ns_;
  long long tick_ns_;  // time of the current tick
};

}  // namespace

void run_loop(Servo& servo, const LoopOptions& options, SpscRing<Frame>* ring,
              LoopStatistics& statistics) noexcept {
  flush_denormals();
  Frame frame;
  Pacer pacer(servo.dt_s());
  for (std::uint64_t n = 0; !options.frames || n < *options.frames; ++n) {
    if (options.stop != nullptr && options.stop->load(std::memory_order_relaxed) != 0) break;
    if (!options.as_fast_as_possible) pacer.wait_for_tick(statistics);
    const bool helped = servo.wants_helpers();
    if (helped) servo.wake_helpers();
    const bool ticked = servo.tick(frame);
    if (helped) servo.rest_helpers();
    if (!ticked) break;
    if (!options.as_fast_as_possible) pacer.frame_done(statistics);
    count(frame, statistics);
    if (ring != nullptr) hand_over(frame, options.as_fast_as_possible, *ring, statistics);
  }
  servo.silence();
}

}  // namespace forcelayer

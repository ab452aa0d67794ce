// The absolute-time loop (DESIGN 7): a tick every dt, whatever the last one took.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "runtime/frame.h"
#include "runtime/histogram.h"
#include "runtime/servo.h"
#include "runtime/spsc_ring.h"

namespace forcelayer {

struct LoopOptions {
  std::optional<std::uint64_t> frames;     // how many; none: until the input ends or stop is set
  bool as_fast_as_possible = false;        // no clock: every frame follows the last at once
  const std::atomic<int>* stop = nullptr;  // ends the loop once it is not 0
};

// What the loop saw, in constant memory.
struct LoopStatistics {
  std::uint64_t frames = 0;
  std::uint64_t force_layer_frames = 0;  // a point in value 2 or 1
  std::uint64_t penetration_frames = 0;  // a point in value 1
  std::uint64_t contact_frames = 0;      // an intersection with depth
  std::uint64_t guard_cuts = 0;
  std::uint64_t outside_map_frames = 0;
  std::uint64_t saturated_frames = 0;
  std::uint64_t faulty_frames = 0;
  std::uint64_t deadline_misses = 0;          // output later than one period after the tick's time
  std::uint64_t skipped_ticks = 0;            // ticks that passed while a frame was late
  std::uint64_t dropped_frames = 0;           // that the ring had no room for
  std::uint64_t outcome_hash = 0;             // of all frames in order
  double max_force_n = 0, max_torque_nm = 0;  // of the step's wrench
  double max_device_force_n = 0, max_device_torque_nm = 0;  // of the device's
  double generated_j = 0;
  DurationHistogram step;    // ns of the step
  DurationHistogram wakeup;  // ns by which the loop woke late
};

// Runs ticks on the calling thread until an end. Each frame goes into `ring`, where there is one:
// in real time a full ring drops the frame, else the loop waits for room. Allocates nothing.
void run_loop(Servo& servo, const LoopOptions& options, SpscRing<Frame>* ring,
              LoopStatistics& statistics) noexcept;

}  // namespace forcelayer

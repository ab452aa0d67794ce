// The absolute-time loop: a tick every dt, however long the last one took.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>

#include "forcelayer/frame.h"
#include "forcelayer/stale_limit.h"
#include "runtime/loop/loop_statistics.h"
#include "runtime/loop/servo.h"
#include "runtime/machine/spsc_ring.h"

namespace forcelayer::loop {

struct LoopOptions {
  std::optional<std::uint64_t> frames;     // how many; none: until the input ends or stop is set
  bool as_fast_as_possible = false;        // no clock: every frame follows the last at once
  const std::atomic<int>* stop = nullptr;  // ends the loop once it is not 0
  double stale_s = kStaleLimitS;           // a frame that begins later than this trips the output
  bool end_on_trip = false;                // the first trip ends the loop
};

// Runs ticks on the calling thread. Ends with the frames or the input, when `stop` is set, at the
// first trip if end_on_trip, and whenever a mapped file is lost. Puts each frame into `ring` if
// there is one: in real time a full ring drops the frame, else the loop waits for room. Allocates
// nothing.
void run_loop(Servo& servo, const LoopOptions& options, machine::SpscRing<Frame>* ring,
              LoopStatistics& statistics) noexcept;

}  // namespace forcelayer::loop

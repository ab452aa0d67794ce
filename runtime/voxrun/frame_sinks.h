// Takes frames off the loop's thread: for trace, recording, progress.
#pragma once

#include <atomic>
#include <functional>
#include <thread>
#include <vector>

#include "forcelayer/frame.h"
#include "formats/result.h"
#include "runtime/machine/spsc_ring.h"

namespace forcelayer::voxrun {

// Takes frames in order. The first error ends the run.
using FrameSink = std::function<Status(const Frame&)>;

// A thread that empties a ring into sinks.
class FrameSinks {
 public:
  // `stop` is set to kSinkFailed when a sink fails. Everything given must outlive this.
  FrameSinks(machine::SpscRing<Frame>& ring, std::vector<FrameSink> sinks, std::atomic<int>& stop);
  ~FrameSinks();

  // Empties the ring, ends the thread and gives the first error. The producer must have ended.
  Status finish();

  static constexpr int kSinkFailed = -1;

 private:
  void run();
  void drain();

  machine::SpscRing<Frame>& ring_;
  std::vector<FrameSink> sinks_;
  std::atomic<int>& stop_;
  std::atomic<bool> ended_{false};
  Status status_;  // of the thread; read after it has ended
  std::thread thread_;
};

}  // namespace forcelayer::voxrun

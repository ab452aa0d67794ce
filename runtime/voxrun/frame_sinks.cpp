#include "runtime/voxrun/frame_sinks.h"

#include <chrono>

namespace forcelayer::voxrun {

FrameSinks::FrameSinks(machine::SpscRing<Frame>& ring, std::vector<FrameSink> sinks,
                       std::atomic<int>& stop)
    : ring_(ring), sinks_(std::move(sinks)), stop_(stop), thread_([this] { run(); }) {}

FrameSinks::~FrameSinks() {
  if (thread_.joinable()) static_cast<void>(finish());
}

void FrameSinks::drain() {
  Frame frame;
  while (ring_.pop(frame)) {
    for (const FrameSink& sink : sinks_) {
      if (!status_) break;
      status_ = sink(frame);
      if (!status_) stop_.store(kSinkFailed, std::memory_order_relaxed);
    }
  }
}

void FrameSinks::run() {
  while (!ended_.load(std::memory_order_acquire)) {
    drain();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  drain();
}

Status FrameSinks::finish() {
  ended_.store(true, std::memory_order_release);
  thread_.join();
  return status_;
}

}  // namespace forcelayer::voxrun

#include "runtime/machine/map_watch.h"

#include "runtime/machine/map_loss.h"
#include "runtime/machine/real_time.h"

namespace forcelayer::machine {

MapWatch::MapWatch()
    : thread_([this] {
        while (!ended_.load(std::memory_order_relaxed)) {
          check_mappings();
          sleep_until_ns(monotonic_ns() + kPeriodNs);
        }
      }) {}

MapWatch::~MapWatch() {
  ended_.store(true, std::memory_order_relaxed);
  thread_.join();
}

}  // namespace forcelayer::machine

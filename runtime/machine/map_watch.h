// A thread that watches the mapped files, and does nothing else.
#pragma once

#include <atomic>
#include <thread>

namespace forcelayer::machine {

// Calls check_mappings() every kPeriodNs for its own lifetime. It reads and writes no file and no
// terminal, so that no slow reader or writer can delay it.
class MapWatch {
 public:
  static constexpr long long kPeriodNs = 1'000'000;

  MapWatch();
  MapWatch(const MapWatch&) = delete;
  MapWatch& operator=(const MapWatch&) = delete;
  ~MapWatch();

 private:
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

}  // namespace forcelayer::machine

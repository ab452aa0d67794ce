// Events of the output while the loop ran: waited, armed, tripped, clutched, and when.
#pragma once

#include <string>
#include <vector>

#include "forcelayer/frame.h"

namespace forcelayer::voxrun {

struct OutputEvent {
  double time_s = 0;
  std::string what;
};

// Watches frames in order, off the loop's thread, and says each change on stderr.
class OutputEvents {
 public:
  static constexpr std::size_t kKept = 1000;  // later ones are said, not kept
  static constexpr double kPatienceS = 0.1;   // that the output may wait without a word

  explicit OutputEvents(bool has_clutch) : has_clutch_(has_clutch) {}

  void see(const Frame& frame);
  void add(double time_s, std::string what, bool say);
  const std::vector<OutputEvent>& events() const { return events_; }
  double last_trip_s() const { return last_trip_s_; }

 private:
  OutputState state_ = OutputState::kWaiting;
  bool has_clutch_;
  bool clutched_ = false;
  bool waited_ = false;
  double last_trip_s_ = 0;
  std::vector<OutputEvent> events_;
};

}  // namespace forcelayer::voxrun

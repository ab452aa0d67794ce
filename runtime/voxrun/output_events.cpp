#include "runtime/voxrun/output_events.h"

#include <cstdio>
#include <utility>

namespace forcelayer::voxrun {

void OutputEvents::add(double time_s, std::string what, bool say) {
  if (say) std::fprintf(stderr, "voxrun: at %.3f s: %s\n", time_s, what.c_str());
  if (events_.size() < kKept) events_.push_back({time_s, std::move(what)});
}

void OutputEvents::see(const Frame& frame) {
  const bool clutched = frame.input.valid == kInputClutched && frame.health.clutch;
  if (clutched != clutched_) add(frame.time_s, clutched ? "clutched" : "clutch released", false);
  clutched_ = clutched;
  const StepReport& step = frame.result.report;
  const bool near = step.interior + step.surface + step.proximity > 0;
  if (near && frame.output == OutputState::kWaiting && frame.time_s >= kPatienceS && !waited_) {
    add(frame.time_s,
        std::string(
            "output waits: the part is in contact or close to the scene; move the part away") +
            (has_clutch_ ? ", or press and release the clutch" : ""),
        true);
    waited_ = true;
  }
  if (frame.output == state_) return;
  const bool again = state_ == OutputState::kTripped;
  state_ = frame.output;
  if (state_ == OutputState::kTripped) {
    last_trip_s_ = frame.time_s;
    add(frame.time_s, std::string("output set to zero: ") + to_text(frame.last_trip), true);
  } else if (state_ == OutputState::kArmed) {
    add(frame.time_s, "output armed", again);
  }
}

}  // namespace forcelayer::voxrun

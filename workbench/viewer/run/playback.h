// The clock of a run that is shown: playing, pausing, stepping, jumping.
#pragma once

#include <vector>

#include "workbench/viewer/run/trace.h"

namespace forcelayer::viewer {

// A position in the rows of a run, which must outlive it and not be empty.
class Playback {
 public:
  explicit Playback(const std::vector<TraceRow>& rows) : rows_(rows) {}

  const TraceRow& row() const { return rows_[at_]; }
  std::size_t index() const { return at_; }
  bool playing() const { return playing_; }

  void toggle();                     // at the end: from the start again
  void advance(double seconds);      // while playing; stops at the end
  void step(std::ptrdiff_t frames);  // pauses
  void seek(double time_s);
  // The next frame (or with `forward` false the last one before) at which contact begins, or the
  // guard cuts; stays where there is none. Pauses.
  void jump_to_contact(bool forward);
  void jump_to_guard_cut(bool forward);

 private:
  template <typename Wanted>
  void jump(bool forward, Wanted wanted);

  const std::vector<TraceRow>& rows_;
  std::size_t at_ = 0;
  double time_s_ = 0;
  bool playing_ = false;
};

}  // namespace forcelayer::viewer

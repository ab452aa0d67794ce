#include "workbench/viewer/run/playback.h"

#include <algorithm>

namespace forcelayer::viewer {

void Playback::toggle() {
  if (!playing_ && at_ + 1 == rows_.size()) at_ = 0;
  playing_ = !playing_;
  time_s_ = row().time_s;
}

void Playback::advance(double seconds) {
  if (!playing_) return;
  time_s_ += seconds;
  at_ = row_at(rows_, time_s_);
  if (at_ + 1 == rows_.size()) playing_ = false;
}

void Playback::step(std::ptrdiff_t frames) {
  playing_ = false;
  const auto last = static_cast<std::ptrdiff_t>(rows_.size()) - 1;
  at_ = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(static_cast<std::ptrdiff_t>(at_) + frames, 0, last));
}

void Playback::seek(double time_s) {
  at_ = row_at(rows_, time_s);
  time_s_ = row().time_s;
}

template <typename Wanted>
void Playback::jump(bool forward, Wanted wanted) {
  playing_ = false;
  for (std::size_t n = at_; forward ? n + 1 < rows_.size() : n > 0;) {
    n = forward ? n + 1 : n - 1;
    if (!wanted(n)) continue;
    at_ = n;
    return;
  }
}

void Playback::jump_to_contact(bool forward) {
  jump(forward, [&](std::size_t n) {
    return rows_[n].contacts > 0 && (n == 0 || rows_[n - 1].contacts == 0);
  });
}

void Playback::jump_to_guard_cut(bool forward) {
  jump(forward, [&](std::size_t n) { return rows_[n].guard_cuts > 0; });
}

}  // namespace forcelayer::viewer

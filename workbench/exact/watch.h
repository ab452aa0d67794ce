// Limits what takes long, and shows that it goes on. Each loop of this room that may take more than
// a moment calls keep_going() at every step.
#pragma once

#include <functional>

namespace forcelayer::exact {

// Thrown by keep_going() in place of the rest of the work.
struct Stopped {};

// While it lives, the loops of this thread ask it now and then, always after the same number of
// steps, whether they may go on. They go on where each of some says so.
class Watch {
 public:
  explicit Watch(std::function<bool()> may_go_on);
  ~Watch();
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

 private:
  friend void keep_going();
  bool may_go_on() const { return may_go_on_() && (outer_ == nullptr || outer_->may_go_on()); }

  std::function<bool()> may_go_on_;
  Watch* outer_;
};

// Throws Stopped where the thread's Watch says so, and from then on each time.
void keep_going();

}  // namespace forcelayer::exact

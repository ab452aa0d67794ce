// A line on a terminal that shows how far a command is.
#pragma once

#include <optional>
#include <string>

namespace forcelayer::command {

// Wipes the line that is on the terminal, if any; the next show() writes it again. For what else is
// printed there. Async-signal-safe.
void wipe_progress_line() noexcept;

// Says on stderr, for a person who waits, what takes long. Nothing where the program's line of
// progress is quiet.
void tell_waiting(const std::string& text);

// Seconds left of what began `elapsed_s` ago, when the fraction `begun` of the whole was done, and
// now is at `done`: at the pace so far. Nothing before a tenth of it is done: nobody knows yet.
std::optional<double> time_left_s(double elapsed_s, double begun, double done);

// Rewritten in place on stderr; nothing where stderr is no terminal, or when quiet. The time left
// is reckoned from the last show() before which nothing was done.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet);
  ~ProgressLine() { clear(); }
  void show(const std::string& stage, double fraction_done);  // fraction in [0, 1]; rate-limited
  // The time left is reckoned from here on: what came before was work of another kind, whose pace
  // says nothing of the rest.
  void reckon_from(double fraction_done);
  void clear();  // wipes the line

 private:
  bool active_;
  double started_s_;
  double begun_ = 0;  // fraction that was done then
  double last_shown_s_ = -1;
};

}  // namespace forcelayer::command

// A line on a terminal that shows how far a command is.
#pragma once

#include <string>

namespace forcelayer::command {

// Rewritten in place on stderr; nothing where stderr is no terminal, or when quiet.
class ProgressLine {
 public:
  explicit ProgressLine(bool quiet);
  ~ProgressLine() { clear(); }
  void show(const std::string& stage, double share_done);  // share in [0, 1]; rate-limited
  void clear();                                            // wipes the line

 private:
  bool active_;
  double started_s_;
  double last_shown_s_ = -1;
};

}  // namespace forcelayer::command

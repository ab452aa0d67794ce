#include "formats/command/progress_line.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace forcelayer::command {
namespace {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

ProgressLine::ProgressLine(bool quiet) : active_(!quiet && isatty(2) == 1), started_s_(now_s()) {}

void ProgressLine::clear() {
  if (active_ && last_shown_s_ >= 0) std::fputs("\r\x1b[K", stderr);
  last_shown_s_ = -1;
}

void ProgressLine::show(const std::string& stage, double share_done) {
  constexpr double kIntervalS = 0.1;
  if (!active_ || now_s() - last_shown_s_ < kIntervalS) return;
  last_shown_s_ = now_s();
  const double elapsed_s = last_shown_s_ - started_s_;
  const double left_s = share_done > 0.01 ? elapsed_s * (1 - share_done) / share_done : 0;
  std::fprintf(stderr, "\r\x1b[K%s  %3.0f%%  %.0f s left", stage.c_str(), 100 * share_done, left_s);
}

}  // namespace forcelayer::command

#include "formats/command/progress_line.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <string_view>

#include "formats/result.h"

namespace forcelayer::command {
namespace {

double now_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The line that stands on the terminal, so that others can wipe it.
std::atomic<bool> on_terminal{false};
std::atomic<bool> is_quiet{false};
constexpr std::string_view kWipe = "\r\x1b[K";

}  // namespace

void wipe_progress_line() noexcept {
  if (!on_terminal.exchange(false)) return;
  const bool wiped = ::write(2, kWipe.data(), kWipe.size()) >= 0;
  static_cast<void>(wiped);  // nobody looks
}

void tell_waiting(const std::string& text) {
  if (is_quiet) return;
  wipe_progress_line();
  std::fprintf(stderr, "%s: %s\n", program_invocation_short_name, escaped(text).c_str());
}

std::optional<double> time_left_s(double elapsed_s, double begun, double done) {
  constexpr double kTold = 0.1;
  const double all = 1 - begun, fraction = done - begun;
  if (!(fraction >= kTold * all) || !(fraction > 0)) return std::nullopt;
  return elapsed_s * (all - fraction) / fraction;
}

ProgressLine::ProgressLine(bool quiet) : active_(!quiet && isatty(2) == 1), started_s_(now_s()) {
  is_quiet = quiet;
}

void ProgressLine::reckon_from(double fraction_done) {
  started_s_ = now_s();
  begun_ = fraction_done;
}

void ProgressLine::clear() {
  if (active_) wipe_progress_line();
  last_shown_s_ = -1;
}

void ProgressLine::show(const std::string& stage, double fraction_done) {
  constexpr double kIntervalS = 0.1;
  const double now = now_s();
  if (fraction_done <= begun_) started_s_ = now;
  if (!active_ || now - last_shown_s_ < kIntervalS) return;
  last_shown_s_ = now;
  char left[32] = "";
  if (const auto left_s = time_left_s(last_shown_s_ - started_s_, begun_, fraction_done)) {
    std::snprintf(left, sizeof left, "  %.0f s left", *left_s);
  }
  std::fprintf(stderr, "%s%s  %3.0f%%%s", kWipe.data(), stage.c_str(), 100 * fraction_done, left);
  on_terminal = true;
}

}  // namespace forcelayer::command

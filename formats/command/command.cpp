#include "formats/command/command.h"

#include <signal.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <new>
#include <span>
#include <string_view>

#include "formats/command/help.h"
#include "formats/command/program.h"
#include "formats/command/progress_line.h"
#include "formats/command/report.h"
#include "formats/file/temporary_files.h"

namespace forcelayer::command {
namespace {

int fail(const char* name, const Error& error) {
  const bool leaves = leaves_errors();
  if (!leaves) print_error(name, error);
  bool is_written = false;
  try {
    is_written = report_failure(error);
  } catch (...) {  // too little memory for it
  }
  if (leaves && !is_written) print_error(name, error);
  return exit_status(error.code);
}

// The end of a text that is made without a call that a signal handler may not make.
std::size_t append(std::span<char> line, std::size_t length, std::string_view text) {
  const std::size_t added = std::min(text.size(), line.size() - length);
  std::copy_n(text.begin(), added, line.begin() + static_cast<std::ptrdiff_t>(length));
  return length + added;
}

extern "C" void end_on_any_signal(int number) { end_on_signal(number); }

std::atomic<int> first_signal = 0;
std::atomic<long> first_at_ms = 0;
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<long>::is_always_lock_free);

long now_ms() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1000 + now.tv_nsec / 1'000'000;
}

}  // namespace

void print_error(const char* name, const Error& error) {
  wipe_progress_line();
  const bool color = wants_color(STDERR_FILENO);
  std::fprintf(stderr, "%s%s:%s %s\n", color ? "\x1b[1;31m" : "", name, color ? "\x1b[0m" : "",
               to_line(error).c_str());
}

bool is_first_stop(int number) {
  constexpr long kAgainMs = 300;  // a person needs longer to send a second signal
  int none = 0;
  if (first_signal.compare_exchange_strong(none, number)) {
    first_at_ms = now_ms();
    return true;
  }
  if (now_ms() - first_at_ms >= kAgainMs) end_on_signal(number);
  return false;
}

int stop_signal() { return first_signal; }

// "voxelize: ended by SIGINT; nothing is left half-written": whatever was begun is removed, and a
// file that is complete stays.
void end_on_signal(int number) {
  const bool removed = remove_temporary_files();
  wipe_progress_line();
  const char* const signal_name = sigabbrev_np(number);
  std::array<char, 256> line{};
  std::size_t length = append(line, 0, program_invocation_short_name);
  length = append(line, length, ": ended by SIG");
  length = append(line, length, signal_name != nullptr ? signal_name : "?");
  length = append(line, length,
                  removed ? "; incomplete files are removed, and earlier files are unchanged\n"
                          : "; no incomplete file is left\n");
  if (number != SIGPIPE) {
    const bool said = ::write(2, line.data(), length) >= 0;
    static_cast<void>(said);  // nobody is there
  }
  _exit(128 + number);
}

void exit_cleanly_on_signals() {
  signal(SIGXFSZ, SIG_IGN);  // a file beyond the user's limit is a failed write with its own line
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    struct sigaction current {};
    sigaction(number, nullptr, &current);
    if (current.sa_handler == SIG_IGN) continue;  // nohup, or a background job of a plain shell
    struct sigaction ours {};
    ours.sa_handler = end_on_any_signal;
    sigfillset(&ours.sa_mask);
    sigaction(number, &ours, nullptr);
  }
}

void end_where_memory_lacks(const char* name) {
  static const char* said_by;
  said_by = name;
  std::set_new_handler([] {
    std::fprintf(stderr, "%s: out of memory; use a machine with more memory\n", said_by);
    std::_Exit(exit_status(ErrorCode::kOutOfMemory));
  });
}

int run_command(const char* name, const std::function<Status()>& body) noexcept {
  std::set_new_handler(nullptr);
  try {
    const Status status = body();
    if (!status) return fail(name, status.error());
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return 0;
    // The answer has reached nobody.
    return fail(name, {ErrorCode::kWriteFailed, "", "standard output", "cannot be written", ""});
  } catch (const std::bad_alloc&) {
    return fail(name, {ErrorCode::kOutOfMemory, "", "", "out of memory",
                       "use a larger voxel size or a machine with more memory"});
  } catch (const std::exception& exception) {
    return fail(name, {ErrorCode::kInternal, "", "", exception.what(), ""});
  } catch (...) {
    return fail(name, {ErrorCode::kInternal, "", "", "unknown exception", ""});
  }
}

std::uint64_t peak_rss_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace forcelayer::command

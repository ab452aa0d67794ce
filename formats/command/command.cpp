#include "formats/command/command.h"

#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "formats/file/atomic_file.h"
#include "formats/file/temporary_files.h"

namespace forcelayer::command {
namespace {

int fail(const char* name, const Error& error) {
  std::fprintf(stderr, "%s: %s\n", name, to_line(error).c_str());
  return exit_status(error.code);
}

extern "C" void end_on_signal(int number) {
  remove_temporary_files();
  _exit(128 + number);
}

// The kernel's answer to a read of a mapped file beyond its new end.
extern "C" void end_on_bus_error(int) {
  remove_temporary_files();
  constexpr std::string_view kMessage =
      ": an input file was cut short while it was being read; start again\n";
  const char* const name = program_invocation_short_name;
  bool said = ::write(2, name, std::strlen(name)) >= 0;
  said = ::write(2, kMessage.data(), kMessage.size()) >= 0 && said;
  _exit(exit_status(ErrorCode::kReadFailed));
}

}  // namespace

void exit_cleanly_on_signals() {
  signal(SIGXFSZ, SIG_IGN);  // a file beyond the user's limit is a failed write with its own line
  signal(SIGBUS, end_on_bus_error);
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGPIPE}) {
    struct sigaction current {};
    sigaction(number, nullptr, &current);
    if (current.sa_handler == SIG_IGN) continue;  // nohup, or a background job of a plain shell
    struct sigaction ours {};
    ours.sa_handler = end_on_signal;
    sigfillset(&ours.sa_mask);
    sigaction(number, &ours, nullptr);
  }
}

int run_command(const char* name, const std::function<Status()>& body) noexcept {
  try {
    const Status status = body();
    return status ? 0 : fail(name, status.error());
  } catch (const std::bad_alloc&) {
    return fail(name, {ErrorCode::kOutOfMemory, "", "", "out of memory",
                       "use a larger voxel size or a machine with more memory"});
  } catch (const std::exception& exception) {
    return fail(name, {ErrorCode::kInternal, "", "", exception.what(), ""});
  } catch (...) {
    return fail(name, {ErrorCode::kInternal, "", "", "unknown exception", ""});
  }
}

Status write_report(const std::string& path, const nlohmann::ordered_json& report) {
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  const std::string text =
      report.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  if (Status written = file->write(std::as_bytes(std::span(text))); !written) return written;
  return file->commit();
}

std::uint64_t peak_rss_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace forcelayer::command

// The frame of every command: one-line errors, exit status, signals, reports.
#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "formats/result.h"

namespace forcelayer::command {

inline constexpr const char* kVersion = FORCELAYER_VERSION;

// From here to run_command() a lack of memory ends the program with one line on stderr. Options are
// declared and parsed there, where nothing catches an exception.
void end_where_memory_lacks(const char* name);

// Runs a command's body and turns its outcome into an exit status. An Error or an escaped exception
// becomes one line on stderr, "COMMAND: ERROR"; std::bad_alloc is kOutOfMemory, and a standard
// output that takes no more is kWriteFailed.
int run_command(const char* name, const std::function<Status()>& body) noexcept;

// The line of an error on stderr: "COMMAND: ERROR".
void print_error(const char* name, const Error& error);

// Writes `report` to `path` atomically, indented, with a final newline; behind the common head
// where it is the report of --json (report.h).
Status write_report(const std::string& path, const nlohmann::ordered_json& report);

// From here on, SIGINT, SIGTERM, SIGHUP and SIGPIPE remove the temporary files of all AtomicFiles
// and end the process with status 128+n, and a line that says so. A signal that the caller ignores
// stays ignored. A write beyond the file-size limit is an error of that write.
void exit_cleanly_on_signals();

// Their action on a signal. Async-signal-safe.
[[noreturn]] void end_on_signal(int number);

// For the handler of a command that ends in order on SIGINT, SIGTERM and SIGHUP. True for the first
// signal of this process. A later one ends the process, but not within 300 ms: whoever signals a
// whole group of processes can reach each of them twice at once. Async-signal-safe.
bool is_first_stop(int number);

// The first signal of is_first_stop(); 0: none came yet.
int stop_signal();

// Highest resident set of this process so far.
std::uint64_t peak_rss_bytes();

}  // namespace forcelayer::command

// The report that --json asks for: the head that all commands share, and reports of failures.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "formats/result.h"

namespace forcelayer::command {

// Version of the reports' common keys (docs/commands.md).
inline constexpr int kReportSchema = 1;

// Notes which report the command line asks for, so that a failure before begin_report() is reported
// there too: with no inputs, and only where that replaces nothing but a report. parse_arguments()
// calls it.
void expect_report(int argc, char** argv);

// Nothing is expected any more: what --json names has been looked at. prepare_outputs() calls it.
void expect_no_report();

// From here on write_report() puts the common head before what is written to `path`, and a failure
// is reported there. `inputs`: as typed; nodes behind "FILE#" count as the file. prepare_outputs()
// calls it.
void begin_report(const std::string& path, std::span<const std::string> inputs);

// Has the report of a failure hold this warning. The report of a success names its own.
void note_warning(const std::string& text);

// Those that were noted.
const std::vector<std::string>& noted_warnings();

// Prints a warning on stderr. Among programs that share their warnings (program.h) the
// first prints it.
void print_warning(const std::string& text);

// Prints it, unless `quiet`, and notes it.
void warn(const std::string& text, bool quiet);

// Writes the error and its exit status into the report that was begun, beside what stands in it
// already; false where none was. run_command() calls it.
bool report_failure(const Error& error);

// Has report_failure() call `tell` first.
void also_tell_failures(void (*tell)(const Error&));

// Writes `text` to `path` atomically.
Status write_text(const std::string& path, const std::string& text);

}  // namespace forcelayer::command

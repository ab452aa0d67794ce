// Files beside the report of --json in which a failure is reported too: a test result, a list of
// issues. Where a job collects such files, one that is left of an earlier run, or missing, reads as
// a success.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/result.h"
#include "runtime/voxcheck/options.h"

namespace forcelayer::voxcheck {

struct FailureFile {
  const char* kind;                                  // of --report, with its colon
  std::vector<std::string_view> beginnings;          // how files of its kind begin
  std::function<std::string(const Error&)> text_of;  // all of it; empty: nothing is reported there
  std::string path = {};                             // empty: what the command line names
  bool checked = false;                              // it may be written to, whatever is there
};

// Those of hosts: JUnit, GitLab, GitHub. `options` are looked at when a failure is reported.
std::vector<FailureFile> failure_files(const Options& options, int argc, char** argv);

// From here on a failure is reported in those of `files` that the command line names; in one that
// is not checked, only where that replaces nothing but a file of its kind. Goes before
// parse_arguments().
void tell_failures_in(std::vector<FailureFile> files, int argc, char** argv);

// The file of that kind is `path`, and is checked: prepare_outputs() has passed it.
void check_failure_file(std::string_view kind, const std::string& path);

}  // namespace forcelayer::voxcheck

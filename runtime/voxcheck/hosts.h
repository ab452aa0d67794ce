// The files of hosts of merge requests: a test result (JUnit), annotations (GitHub), issues
// (GitLab).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/voxcheck/failure_files.h"
#include "runtime/voxcheck/options.h"

namespace forcelayer::voxcheck {

enum class TestEnd { kPassed, kFailed, kBroken };

// The file of one test case: the path, of the class that is the part. `message` is not shown of
// one that passed. Holds the warnings noted so far.
std::string junit_text(const Options& options, TestEnd end, const std::string& message,
                       const std::string& output, double seconds);

// A line that GitHub shows at the path's file; `level` is error or warning.
std::string annotation(const Options& options, const char* level, const char* title,
                       const std::string& about);
// A line for each warning noted so far.
std::string warning_annotations(const Options& options);

// One of the list that GitLab calls Code Quality.
nlohmann::ordered_json issue(const Options& options, const char* check, const char* severity,
                             const std::string& about);
// A list with one for each warning noted so far.
nlohmann::ordered_json warning_issues(const Options& options);

// Where a failure is reported, instead of an earlier verdict. `options` are looked at then.
std::vector<FailureFile> failure_files(const Options& options, int argc, char** argv);

}  // namespace forcelayer::voxcheck

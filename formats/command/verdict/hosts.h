// A verdict in the forms of hosts of merge requests: a test result (JUnit), annotations (GitHub),
// issues (GitLab).
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "formats/command/verdict/verdict.h"

namespace forcelayer::command {

// The subject of a report.
struct Subject {
  std::string tool;        // "voxcheck"
  std::string part, path;  // files; the path is where hosts show an answer
};

// The file of one test case: the path, of the class that is the part. It fails where the answer is
// not yes. Holds the warnings noted so far.
std::string junit_text(const Subject& subject, const Verdict& verdict, double seconds);
// The same of a check that ended without a verdict.
std::string junit_text(const Subject& subject, const Error& error);

// A line that GitHub shows at the path's file; `level` is error or warning.
std::string annotation(const Subject& subject, const char* level, const char* title,
                       const std::string& about);
// A line for each warning noted so far, and for each stretch in which the answer is no.
std::string annotations(const Subject& subject, const Verdict& verdict);

// One of the list that GitLab calls Code Quality.
nlohmann::ordered_json issue(const Subject& subject, const char* check, const char* severity,
                             const std::string& about);
// A list with one for each warning noted so far, and for each stretch in which the answer is no.
nlohmann::ordered_json issues(const Subject& subject, const Verdict& verdict);
nlohmann::ordered_json warning_issues(const Subject& subject);

}  // namespace forcelayer::command

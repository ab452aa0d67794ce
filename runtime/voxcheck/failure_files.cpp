#include "runtime/voxcheck/failure_files.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "formats/command/report.h"
#include "formats/command/report_path.h"
#include "formats/command/verdict/hosts.h"
#include "runtime/voxcheck/report.h"

namespace forcelayer::voxcheck {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kName = "voxcheck";  // of issues that are no violations

constexpr std::string_view kJunit =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"voxcheck\"";
constexpr std::string_view kJunitOfStudy =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"forcelayer study\"";

bool is_verdict(const Error& error) { return command::is_answer(error.code); }

std::vector<FailureFile> told;  // of this process

bool may_write(const FailureFile& file) {
  if (file.path.empty()) return false;
  return file.checked || std::any_of(file.beginnings.begin(), file.beginnings.end(),
                                     [&](std::string_view beginning) {
                                       return command::may_replace(file.path, beginning);
                                     });
}

void tell(const Error& error) {
  for (const FailureFile& file : told) {
    if (!may_write(file)) continue;
    const std::string text = file.text_of(error);
    if (text.empty()) continue;
    const Status written = command::write_text(file.path, text);
    static_cast<void>(written);  // the command has failed already, and says so
  }
}

}  // namespace

std::vector<FailureFile> failure_files(const Options& options, int argc, char** argv) {
  const auto junit = [&options](const Error& error) -> std::string {
    if (is_verdict(error)) return "";
    return command::junit_text(subject_of(options), error);
  };
  const auto issues = [&options](const Error& error) -> std::string {
    if (is_verdict(error)) return "";
    const command::Subject subject = subject_of(options);
    Json list = command::warning_issues(subject);
    list.insert(list.begin(), command::issue(subject, kName, "critical", to_line(error)));
    return list.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  };
  const auto lines = [&options](const Error& error) -> std::string {
    if (is_verdict(error)) return "";
    return command::annotation(subject_of(options), "error", kName, to_line(error));
  };
  std::vector<FailureFile> files{{"junit:", {kJunit, kJunitOfStudy}, junit},
                                 {"gitlab:", {"[]", "[\n  {\n    \"description\""}, issues}};
  for (int n = 1; n < argc; ++n) {
    const std::string_view argument = argv[n];
    const bool behind = argument == "--report" && n + 1 < argc;
    if (argument == "--report=github" || (behind && argv[n + 1] == std::string_view("github"))) {
      files.push_back({"github", {}, lines, "/dev/stdout", true});
      break;
    }
  }
  return files;
}

void tell_failures_in(std::vector<FailureFile> files, int argc, char** argv) {
  told = std::move(files);
  for (FailureFile& file : told) {
    if (file.path.empty()) file.path = command::file_named_by("--report", argc, argv, file.kind);
  }
  command::also_tell_failures(tell);
}

void check_failure_file(std::string_view kind, const std::string& path) {
  for (FailureFile& file : told) {
    if (file.kind != kind) continue;
    file.path = path;
    file.checked = true;
  }
}

}  // namespace forcelayer::voxcheck

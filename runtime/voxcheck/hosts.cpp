#include "runtime/voxcheck/hosts.h"

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "formats/command/report.h"
#include "formats/command/text.h"

namespace forcelayer::voxcheck {
namespace {

using command::text;
using Json = nlohmann::ordered_json;

constexpr const char* kName = "voxcheck";  // of issues that are no violations
constexpr std::string_view kJunitBeginning =
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"voxcheck\"";

std::string xml(std::string_view plain) {
  std::string escaped_text;
  for (const char c : plain) {
    switch (c) {
      case '&':
        escaped_text += "&amp;";
        break;
      case '<':
        escaped_text += "&lt;";
        break;
      case '>':
        escaped_text += "&gt;";
        break;
      case '"':
        escaped_text += "&quot;";
        break;
      default:
        escaped_text += c;
    }
  }
  return escaped_text;
}

// Escapes the characters that a line of a GitHub annotation must not hold; in a property also ":"
// and ",".
std::string github_escaped(std::string_view plain, bool is_property) {
  std::string escaped_text;
  for (const char c : plain) {
    if (c == '%' || c == '\r' || c == '\n' || (is_property && (c == ':' || c == ','))) {
      escaped_text += text("%%%02X", static_cast<unsigned char>(c));
    } else {
      escaped_text += c;
    }
  }
  return escaped_text;
}

// The path's file as hosts name files: from the folder of the checkout on, in which jobs run.
std::string file_of_path(const Options& options) {
  namespace fs = std::filesystem;
  fs::path path = fs::path(options.path).lexically_normal();
  std::error_code failure;
  if (path.is_absolute()) {
    const fs::path below = path.lexically_relative(fs::current_path(failure));
    if (!failure && !below.empty() && *below.begin() != "..") path = below;
  }
  return path.string();
}

bool is_verdict(const Error& error) { return error.code == ErrorCode::kAnswerIsNo; }

}  // namespace

std::string junit_text(const Options& options, TestEnd end, const std::string& message,
                       const std::string& output, double seconds) {
  std::string content(kJunitBeginning);
  content += text(" tests=\"1\" failures=\"%d\" errors=\"%d\" time=\"%.3f\">\n",
                  end == TestEnd::kFailed ? 1 : 0, end == TestEnd::kBroken ? 1 : 0, seconds);
  content += "  <testcase classname=\"" + xml(escaped(options.part)) + "\" name=\"" +
             xml(escaped(options.path)) + text("\" time=\"%.3f\">\n    ", seconds);
  if (end == TestEnd::kPassed) {
    content += "<system-out>" + xml(output) + "</system-out>\n";
  } else {
    const char* const tag = end == TestEnd::kFailed ? "failure" : "error";
    content +=
        text("<%s message=\"", tag) + xml(message) + "\">" + xml(output) + text("</%s>\n", tag);
  }
  std::string warnings;
  for (const std::string& warning : command::noted_warnings()) {
    warnings += "warning: " + escaped(warning) + "\n";
  }
  if (!warnings.empty()) content += "    <system-err>" + xml(warnings) + "</system-err>\n";
  return content + "  </testcase>\n</testsuite>\n";
}

std::string annotation(const Options& options, const char* level, const char* title,
                       const std::string& about) {
  const std::string file = file_of_path(options);
  return text("::%s ", level) + (file.empty() ? "" : "file=" + github_escaped(file, true) + ",") +
         text("title=%s::", title) + github_escaped(about, false) + "\n";
}

std::string warning_annotations(const Options& options) {
  std::string lines;
  for (const std::string& warning : command::noted_warnings()) {
    lines += annotation(options, "warning", kName, escaped(warning));
  }
  return lines;
}

Json issue(const Options& options, const char* check, const char* severity,
           const std::string& about) {
  const std::string file = file_of_path(options);
  const std::string told_apart_by = file + "\n" + options.part + "\n" + about;
  return {{"description", about},
          {"check_name", check},
          {"fingerprint", text("%016zx", std::hash<std::string>()(told_apart_by))},
          {"severity", severity},
          {"location", {{"path", file}, {"lines", {{"begin", 1}}}}}};
}

Json warning_issues(const Options& options) {
  Json list = Json::array();
  for (const std::string& warning : command::noted_warnings()) {
    list.push_back(issue(options, kName, "info", escaped(warning)));
  }
  return list;
}

std::vector<FailureFile> failure_files(const Options& options, int argc, char** argv) {
  const auto junit = [&options](const Error& error) -> std::string {
    if (is_verdict(error)) return "";
    return junit_text(options, TestEnd::kBroken, to_line(error), to_line(error) + "\n", 0);
  };
  const auto issues = [&options](const Error& error) -> std::string {
    if (is_verdict(error)) return "";
    Json list = warning_issues(options);
    list.insert(list.begin(), issue(options, kName, "critical", to_line(error)));
    return list.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  };
  const auto lines = [&options](const Error& error) -> std::string {
    if (is_verdict(error)) return "";
    return annotation(options, "error", kName, to_line(error));
  };
  std::vector<FailureFile> files{{"junit:", {kJunitBeginning}, junit},
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

}  // namespace forcelayer::voxcheck

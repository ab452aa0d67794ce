#include "formats/command/verdict/hosts.h"

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "formats/command/report.h"
#include "formats/command/text.h"

namespace forcelayer::command {
namespace {

using Json = nlohmann::ordered_json;

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
std::string file_of_path(const Subject& subject) {
  namespace fs = std::filesystem;
  fs::path path = fs::path(subject.path).lexically_normal();
  std::error_code failure;
  if (path.is_absolute()) {
    const fs::path below = path.lexically_relative(fs::current_path(failure));
    if (!failure && !below.empty() && *below.begin() != "..") path = below;
  }
  return path.string();
}

std::string junit(const Subject& subject, const char* tag, const std::string& message,
                  const std::string& output, double seconds) {
  const std::string_view kind = tag;
  std::string content = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"";
  content += subject.tool + "\"" +
             text(" tests=\"1\" failures=\"%d\" errors=\"%d\" time=\"%.3f\">\n",
                  kind == "failure" ? 1 : 0, kind == "error" ? 1 : 0, seconds);
  content += "  <testcase classname=\"" + xml(escaped(subject.part)) + "\" name=\"" +
             xml(escaped(subject.path)) + text("\" time=\"%.3f\">\n    ", seconds);
  content += text("<%s", tag) + (message.empty() ? "" : " message=\"" + xml(message) + "\"") + ">" +
             xml(output) + text("</%s>\n", tag);
  std::string warnings;
  for (const std::string& warning : noted_warnings()) {
    warnings += "warning: " + escaped(warning) + "\n";
  }
  if (!warnings.empty()) content += "    <system-err>" + xml(warnings) + "</system-err>\n";
  return content + "  </testcase>\n</testsuite>\n";
}

}  // namespace

std::string junit_text(const Subject& subject, const Verdict& verdict, double seconds) {
  const bool yes = is_yes(verdict.kind);
  return junit(subject, yes ? "system-out" : "failure", yes ? "" : sentence(verdict),
               terminal_text(verdict), seconds);
}

std::string junit_text(const Subject& subject, const Error& error) {
  return junit(subject, "error", to_line(error), to_line(error) + "\n", 0);
}

std::string annotation(const Subject& subject, const char* level, const char* title,
                       const std::string& about) {
  const std::string file = file_of_path(subject);
  return text("::%s ", level) + (file.empty() ? "" : "file=" + github_escaped(file, true) + ",") +
         text("title=%s::", title) + github_escaped(about, false) + "\n";
}

std::string annotations(const Subject& subject, const Verdict& verdict) {
  std::string lines;
  for (const std::string& warning : noted_warnings()) {
    lines += annotation(subject, "warning", subject.tool.c_str(), escaped(warning));
  }
  if (!is_yes(verdict.kind)) {
    lines += annotation(subject, "error", "clearance", sentence(verdict));
    for (const std::string& more : verdict.more) {
      lines += annotation(subject, "error", "clearance", more);
    }
  }
  for (const std::string& remark : verdict.remarks) {
    lines += annotation(subject, "warning", "overlap", remark);
  }
  return lines;
}

Json issue(const Subject& subject, const char* check, const char* severity,
           const std::string& about) {
  const std::string file = file_of_path(subject);
  const std::string told_apart_by = file + "\n" + subject.part + "\n" + about;
  return {{"description", about},
          {"check_name", check},
          {"fingerprint", text("%016zx", std::hash<std::string>()(told_apart_by))},
          {"severity", severity},
          {"location", {{"path", file}, {"lines", {{"begin", 1}}}}}};
}

Json warning_issues(const Subject& subject) {
  Json list = Json::array();
  for (const std::string& warning : noted_warnings()) {
    list.push_back(issue(subject, subject.tool.c_str(), "info", escaped(warning)));
  }
  return list;
}

Json issues(const Subject& subject, const Verdict& verdict) {
  Json list = warning_issues(subject);
  if (!is_yes(verdict.kind)) {
    list.push_back(issue(subject, "clearance", "major", sentence(verdict)));
    for (const std::string& more : verdict.more) {
      list.push_back(issue(subject, "clearance", "major", more));
    }
  }
  for (const std::string& remark : verdict.remarks) {
    list.push_back(issue(subject, "overlap", "minor", remark));
  }
  return list;
}

}  // namespace forcelayer::command

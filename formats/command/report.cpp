#include "formats/command/report.h"

#include <errno.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "formats/command/command.h"
#include "formats/command/program.h"
#include "formats/command/progress_line.h"
#include "formats/command/report_path.h"
#include "formats/command/version.h"
#include "formats/file/atomic_file.h"
#include "formats/file/named_file.h"
#include "formats/section_table.h"

namespace forcelayer::command {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// The report of this process. Its writers are on one thread.
struct Begun {
  std::string path;
  std::vector<std::string> inputs;
  std::vector<std::string> warnings;
  Json written;
};
Begun begun;
std::string expected;                      // path of a report that was not begun
void (*tell_too)(const Error&) = nullptr;  // of also_tell_failures()

// As the baked files' own checksums: XXH3, 64 bits. Null where it is no file that can be read.
Json hash_of(const std::string& path) {
  std::error_code failure;
  if (!fs::is_regular_file(path, failure)) return nullptr;
  const auto hash = checksum_of_file(path);
  if (!hash) return nullptr;
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(*hash));
  return std::string(text);
}

// Assignments: lists in braces compile to ten times as much.
Json head() {
  Json report;
  report["schema_version"] = kReportSchema;
  report["tool"] = program_invocation_short_name;
  report["tool_version"] = kVersion;
  report["commit"] = std::string(commit());
  report["exit_status"] = 0;
  Json& warnings = report["warnings"] = Json::array();
  for (const std::string& warning : begun.warnings) warnings.push_back(warning);
  Json& inputs = report["input_files"] = Json::array();
  for (const std::string& path : begun.inputs) {
    Json& input = inputs.emplace_back();
    input["path"] = path;
    input["xxh3"] = hash_of(path);
  }
  return report;
}

Status write_json(const std::string& path, const Json& report) {
  return write_text(path, report.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace

Status write_text(const std::string& path, const std::string& text) {
  auto file = AtomicFile::create(path);
  if (!file) return file.error();
  if (Status written = file->write(std::as_bytes(std::span(text))); !written) return written;
  return file->commit();
}

void expect_report(int argc, char** argv) { expected = file_named_by("--json", argc, argv); }

void expect_no_report() { expected.clear(); }

void begin_report(const std::string& path, std::span<const std::string> inputs) {
  begun = {path, {}, {}, nullptr};
  for (const std::string& input : inputs) {
    if (!input.empty()) begun.inputs.push_back(file_of(input));
  }
}

Status write_report(const std::string& path, const Json& report) {
  if (path.empty() || path != begun.path) return write_json(path, report);
  Json whole = head();
  for (const auto& [key, value] : report.items()) whole[key] = value;
  Status written = write_json(path, whole);
  if (written) begun.written = std::move(whole);
  return written;
}

void note_warning(const std::string& text) { begun.warnings.push_back(with_known_options(text)); }

void print_warning(const std::string& text) {
  const std::string line = escaped(with_known_options(text));
  if (!is_new_warning(line)) return;
  wipe_progress_line();
  std::fprintf(stderr, "%s: warning: %s\n", program_invocation_short_name, line.c_str());
}

void warn(const std::string& text, bool quiet) {
  note_warning(text);
  if (!quiet) print_warning(text);
}

const std::vector<std::string>& noted_warnings() { return begun.warnings; }

void also_tell_failures(void (*tell)(const Error&)) { tell_too = tell; }

bool report_failure(const Error& error) {
  if (tell_too != nullptr) tell_too(error);
  if (begun.path.empty() && !expected.empty() && may_replace(expected, "{\n  \"schema_version\"")) {
    begun.path = expected;
  }
  if (begun.path.empty()) return false;
  const bool stream = begun.path.starts_with("/dev/");  // what is written there cannot be replaced
  if (stream && !begun.written.is_null()) return false;
  Json report = begun.written.is_null() ? head() : begun.written;
  report["exit_status"] = exit_status(error.code);
  Json& told = report["error"];
  told["code"] = static_cast<int>(error.code);
  told["file"] = error.file;
  told["where"] = error.where;
  told["what"] = error.what;
  told["mend"] = error.mend;
  told["line"] = to_line(error);
  return write_json(begun.path, report).ok();  // the command has failed already
}

}  // namespace forcelayer::command

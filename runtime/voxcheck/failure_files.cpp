#include "runtime/voxcheck/failure_files.h"

#include <algorithm>
#include <utility>

#include "formats/command/report.h"
#include "formats/command/report_path.h"

namespace forcelayer::voxcheck {
namespace {

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

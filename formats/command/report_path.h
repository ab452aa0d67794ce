// Where a report goes before the outputs have been checked.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace forcelayer::command {

// The file that the command line names behind `option`, before it is parsed; empty where none.
// `kind`: only values that begin so count, and the file is behind it ("junit:").
inline std::string_view file_named_by(std::string_view option, int argc, char** argv,
                                      std::string_view kind = {}) {
  std::string_view named;
  for (int n = 1; n < argc; ++n) {
    std::string_view argument = argv[n];
    if (!argument.starts_with(option)) continue;
    argument.remove_prefix(option.size());
    std::string_view value;
    if (argument.empty() && n + 1 < argc) value = argv[n + 1];
    if (argument.starts_with('=')) value = argument.substr(1);
    if (!value.empty() && value.starts_with(kind)) named = value.substr(kind.size());
  }
  return named == "-" ? "/dev/stdout" : named;
}

// Whether nothing is lost where `path` is written to but a file that begins so, with 80 letters at
// most.
inline bool may_replace(const std::string& path, std::string_view beginning) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(path, failure)) {
    return !std::filesystem::is_directory(path, failure);
  }
  char there[80] = {};
  std::ifstream(path, std::ios::binary).read(there, sizeof there);
  return std::string_view(there, sizeof there).starts_with(beginning);
}

}  // namespace forcelayer::command

// The files that a command writes: none of them may destroy an input, or a file of another kind.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/result.h"

namespace forcelayer::command {

enum class FileKind {
  kVoxmap,
  kPshell,
  kReport,
  kTable,
  kRecording,
  kPicture,
  kAnimation,
  kExport
};

// A file that the user asked for.
struct OutputFile {
  const char* option;  // that names it, for errors
  std::string* path;   // as typed; empty where the option was not given
  FileKind kind;
};

// Checks, before anything is read or written, that no output
// - is an input: the same file by any name, link or "FILE#NODE";
// - is another output;
// - has an ending that belongs to another kind of file ("scene.stl" for a voxmap);
// - replaces a file that does not begin as those of its kind do that commands write. An empty file,
//   a device and a pipe can be written to;
// - lies in a folder that is not there, or where the user may not write: kWriteFailed.
// "-" becomes a path that writes to standard output, and what else the command prints goes to
// standard error. What --json names becomes the command's report (report.h). Other errors: kUsage.
Status prepare_outputs(std::span<const OutputFile> outputs, std::span<const std::string> inputs);

// The same checks alone, for files that a command names itself, and without inputs.
Status check_outputs(std::span<const OutputFile> outputs);

}  // namespace forcelayer::command

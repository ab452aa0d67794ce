// `voxinfo path`: what a path is, and other paths made of it.
#pragma once

#include <string>

#include "formats/result.h"

namespace forcelayer::voxinfo {

struct PathRequest {
  std::string path;   // a CSV of poses, or a trace
  std::string shell;  // of the part, for its centroid; empty: not known
  std::string json, output;
  std::string period;  // to resample at, such as 1ms; empty: not
  bool reverse = false, quiet = false;
};

// Prints the path's facts, and writes it anew where an output is named. Errors: those of
// read_path(), of Pshell::open() and of writing; kUsage for an invalid period.
Status handle_path(const PathRequest& request);

}  // namespace forcelayer::voxinfo

// What voxplan says: for people, and for scripts.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "formats/path/path_file.h"
#include "runtime/clearance/path_check.h"
#include "runtime/voxplan/options.h"
#include "runtime/voxplan/problem.h"
#include "runtime/voxplan/search.h"

namespace forcelayer::voxplan {

struct Report {
  const Options& options;
  const Problem& problem;
  const SearchResult& result;
  std::vector<PathRow> rows;       // of the path that was found,
  clearance::CheckResult checked;  // and its proof
  double total_s = 0;
};

// "path found: ...", a line.
std::string found_text(const Report& report);

// "no path found in 60 s (best: out to 31 mm, blocked by bracket_12)".
std::string not_found_text(const Report& report);

nlohmann::ordered_json report_json(const Report& report);

}  // namespace forcelayer::voxplan

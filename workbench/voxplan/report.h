// The answer, for people and for scripts.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "workbench/voxplan/check/problem.h"
#include "workbench/voxplan/options.h"
#include "workbench/voxplan/plan.h"

namespace forcelayer::voxplan {

struct Report {
  const Options& options;
  const Problem& problem;
  const Plan& plan;
};

// "path found: ...", a line.
std::string found_text(const Report& report);

// "no path found in 60 s (best: out to 31 mm, blocked by bracket_12, rib_3)".
std::string not_found_text(const Report& report);

nlohmann::ordered_json report_json(const Report& report);

}  // namespace forcelayer::voxplan

// The report of a check: for people, for scripts, and for hosts of merge requests.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/path/path_file.h"
#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"
#include "runtime/clearance/path_check.h"
#include "runtime/voxcheck/exact_exchange.h"
#include "runtime/voxcheck/options.h"

namespace forcelayer::voxcheck {

// A check and what it was of.
struct Report {
  const Options& options;
  const Voxmap& scene;
  const Pshell& part;
  const clearance::CheckResult& result;
  const std::optional<ExactAnswer>& exact;  // of --exact: violations are then in the same order
  double read_s = 0, check_s = 0;
};

// The violation with the least clearance; there must be one.
const clearance::Violation& worst_of(const clearance::CheckResult& result);

// The measurement by the meshes of a violation in the report; null without --exact, and where the
// meshes cannot settle it.
const ExactViolation* exact_of(const Report& report, const clearance::Violation& violation);

// The words above a picture: the verdict, and what is drawn.
std::vector<std::string> picture_title(const Report& report);

// The verdict, a line; for each of the first violations another one.
std::string verdict_text(const Report& report);

nlohmann::ordered_json report_json(const Report& report);

// `from_s,to_s,clearance_m`: what is proven from one time to another.
Status write_curve(const Report& report);

// One test case, failed where the path is not clear.
Status write_junit(const Report& report);

// A line for each warning and violation that GitHub shows beside the path's file.
std::string github_lines(const Report& report);

// The list that GitLab calls Code Quality.
nlohmann::ordered_json code_quality_json(const Report& report);

// An error where the path is not clear; `first` and `last` of its poses tell where the part may be
// installed. Errors: kAnswerIsNo.
Status check_verdict(const Report& report, const PathRow& first, const PathRow& last);

}  // namespace forcelayer::voxcheck

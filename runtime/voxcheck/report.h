// The report of a check: for people, for scripts, and for hosts of merge requests.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/command/verdict/hosts.h"
#include "formats/command/verdict/verdict.h"
#include "formats/result.h"
#include "runtime/voxcheck/exact_exchange.h"
#include "runtime/voxcheck/options.h"
#include "runtime/voxcheck/path_verdict.h"

namespace forcelayer::voxcheck {

// A check and what it was of.
struct Report {
  const Options& options;
  const CheckedPath checked;
  const std::optional<ExactAnswer>& exact;  // of --exact: violations are then in the same order
  double read_s = 0, check_s = 0;
};

// The verdict with advice and notes; all that follows is written from it.
command::Verdict verdict_of(const Report& report);

// The words above a picture: the verdict, and what is drawn.
std::vector<std::string> picture_title(const command::Verdict& verdict);

nlohmann::ordered_json report_json(const Report& report, const command::Verdict& verdict);

// `from_s,to_s,clearance_m,from_m,to_m`: what is proven from one time, and place on the path, to
// another.
Status write_curve(const Report& report);

// The name and files of the check, for hosts.
command::Subject subject_of(const Options& options);

}  // namespace forcelayer::voxcheck

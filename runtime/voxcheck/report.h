// The report of a check: for people, for scripts, and for hosts of merge requests.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
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
  const clearance::LeftOut* left_out = nullptr;  // of --rules: objects that another report is about
  bool is_far = false;                           // nothing of the scene is near
};

// The verdict with advice and notes; all that follows is written from it.
command::Verdict verdict_of(const Report& report);

// The verdict of several reports, each about objects that must keep another distance by --rules: no
// where one of them is no, and else a yes of all. `told`: the report that it speaks of, the worst.
struct RulesVerdict {
  std::size_t told = 0;
  command::Verdict verdict;
};
RulesVerdict verdict_of(std::span<const Report> reports);

// The key `rules` of --json: a list of those reports, and of the objects that no report is about.
nlohmann::ordered_json rules_json(std::span<const Report> reports);

// The words above a picture: the verdict, and what is drawn.
std::vector<std::string> picture_title(const command::Verdict& verdict);

nlohmann::ordered_json report_json(const Report& report, const command::Verdict& verdict);

// `from_s,to_s,clearance_m,from_m,to_m`: what is proven from one time, and place on the path, to
// another.
Status write_curve(const Report& report);

// The name and files of the check, for hosts.
command::Subject subject_of(const Options& options);

}  // namespace forcelayer::voxcheck

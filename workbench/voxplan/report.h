// The answer, for people and for scripts.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "formats/command/verdict/verdict.h"
#include "runtime/clearance/path_length.h"
#include "workbench/voxplan/check/problem.h"
#include "workbench/voxplan/options.h"
#include "workbench/voxplan/plan.h"

namespace forcelayer::voxplan {

struct Report {
  Report(const Options& of_options, const Problem& of_problem, const Plan& of_plan);

  const Options& options;
  const Problem& problem;
  const Plan& plan;
  // None where none was found.
  const std::optional<clearance::CenterPath> path;
  const std::optional<clearance::PathLength> length;
  const command::Verdict verdict;  // all answers are written from it
};

nlohmann::ordered_json report_json(const Report& report);

}  // namespace forcelayer::voxplan

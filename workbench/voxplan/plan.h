// The order of a plan: start, search, widening, proof.
#pragma once

#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "formats/path/path_file.h"
#include "formats/result.h"
#include "runtime/clearance/path_check.h"
#include "workbench/exact/exact_check.h"
#include "workbench/voxplan/check/problem.h"
#include "workbench/voxplan/options.h"
#include "workbench/voxplan/search.h"

namespace forcelayer::voxplan {

struct Plan {
  SearchResult search;
  std::vector<PathRow> rows;       // of the path that was found, else of SearchResult::farthest
  clearance::CheckResult checked;  // the proof of the path that was found
  std::optional<voxcheck::ExactAnswer> exact;  // the same by the meshes, where they are given
  // Objects that the installed part overlaps for certain, and by how much at least, m.
  std::vector<std::pair<std::uint32_t, double>> overlaps;
  double seconds = 0;
};

// Where `meshes` are given, only a path is found that they settle. Errors: kUsage where the part
// cannot start or end where it is asked to; kAnswerIsNo where the meshes can settle no path; those
// of check_path() and exact::check_exactly().
Result<Plan> plan(const Problem& problem, const Options& options, const exact::Meshes* meshes,
                  const std::function<void(double fraction_of_time, double out_m)>& progress);

}  // namespace forcelayer::voxplan

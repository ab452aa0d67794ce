// --exact: the meshes settle what the baked files leave open. The program voxcheck-exact measures.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "formats/result.h"
#include "runtime/clearance/path_check.h"
#include "runtime/voxcheck/exact_exchange.h"
#include "runtime/voxcheck/options.h"

namespace forcelayer::voxcheck {

// Names the meshes in a request.
void name_meshes(const MeshOptions& options, ExactRequest& request);

// Who measures. ask_program() starts voxcheck-exact.
using AskExactly = std::function<Result<ExactAnswer>(const ExactRequest&)>;
Result<ExactAnswer> ask_program(const ExactRequest& request);

struct ExactCheckResult {
  clearance::CheckResult checked;
  ExactAnswer exact;
};

// Checks the path by the files, and has the meshes settle what these leave open: the exact distance
// where the files prove less than is required and where the least may be. The violations are then
// those of the meshes, each at the same place as in the answer, and behind them parts that are
// pushed into their seats. `options` names the meshes. Objects of the seat that the meshes know to
// be as far away as required where the part is installed are then not of it: the path is checked
// again. Errors: those of check_path() and of reading meshes; kFilesDoNotMatch where they are not
// those of the files.
Result<ExactCheckResult> check_with_meshes(const Voxmap& scene, const Pshell& part,
                                           const clearance::CenterPath& path,
                                           clearance::CheckRequest request, const Options& options,
                                           const AskExactly& ask);

// Objects that must keep one distance from the part.
struct RuleGroup {
  double required_m = 0;
  clearance::LeftOut left_out;  // all others, and those of --allow
};
// The objects by --rules, the largest distance first: each object that counts is of one group. One
// group that leaves all out, where no object counts. Warnings of the rules are added to `warnings`.
// Errors: those of `ask`.
Result<std::vector<RuleGroup>> groups_by_rules(const Options& options,
                                               const clearance::LeftOut& allowed,
                                               const AskExactly& ask,
                                               std::vector<std::string>& warnings);

// Has the clearance map written of all objects that a group counts, for the largest of the groups'
// distances. Adds warnings. Errors: those of `ask`.
Status write_map(const Options& options, std::span<const RuleGroup> groups, const AskExactly& ask,
                 std::vector<std::string>& warnings);

}  // namespace forcelayer::voxcheck

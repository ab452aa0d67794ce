// --exact: the meshes settle what the baked files leave open. The program voxcheck-exact measures.
#pragma once

#include <functional>

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

}  // namespace forcelayer::voxcheck

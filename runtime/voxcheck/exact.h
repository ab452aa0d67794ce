// --exact: the meshes settle what the baked files leave open. The program voxcheck-exact measures.
#pragma once

#include "formats/result.h"
#include "runtime/clearance/path_check.h"
#include "runtime/voxcheck/exact_exchange.h"
#include "runtime/voxcheck/options.h"

namespace forcelayer::voxcheck {

// Asks for the exact distance where the files prove less than is required and where the least may
// be, and puts what comes back into `result`: its violations are then those of the meshes, each at
// the same place as in the answer, and behind them parts that are pushed into their seats. Errors:
// those of reading meshes; kFilesDoNotMatch where they are not those of the files.
Result<ExactAnswer> settle_exactly(const Options& options, const clearance::LeftOut& allowed,
                                   clearance::CheckResult& result);

// Adds those objects of the seat that are as far away as required where the part is installed, by
// the meshes. Whether there are any: the path has to be checked again.
bool leave_out_far(const ExactAnswer& answer, double required_m, clearance::LeftOut& far_in_seat);

}  // namespace forcelayer::voxcheck

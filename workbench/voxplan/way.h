// A way that was found: made wider, given times, and proven.
#pragma once

#include <vector>

#include "formats/path/path_file.h"
#include "formats/result.h"
#include "runtime/clearance/path_check.h"
#include "workbench/voxplan/check/pose_check.h"
#include "workbench/voxplan/check/problem.h"
#include "workbench/voxplan/search.h"

namespace forcelayer::voxplan {

// Moves the poses between the first and the last, and others put between them, to where the proven
// clearance is larger, as far as the stored distances tell it. Every motion keeps the clearance
// that is required, and no pose comes nearer than it was. Errors: those of PoseCheck::create().
Result<Way> widened(const Problem& problem, const Way& way, std::uint64_t seed);

// Poses of the part (world_from_part) over time: its points go at `speed_mps` or less.
std::vector<PathRow> rows_of(const Problem& problem, const Way& in_seat, const Way& beyond,
                             double speed_mps);

// The verdict of voxcheck: kInSeat with the start as seat, which is clear where shell points feel
// nothing; kClear without a seat.
Result<clearance::CheckResult> proven(const Problem& problem, const std::vector<PathRow>& rows,
                                      Rule rule, unsigned threads);

}  // namespace forcelayer::voxplan

// A way that was found: made wider, given times, and proven.
#pragma once

#include <vector>

#include "formats/path/path_file.h"
#include "formats/result.h"
#include "runtime/clearance/path_check.h"
#include "runtime/voxplan/pose_check.h"
#include "runtime/voxplan/problem.h"
#include "runtime/voxplan/search.h"

namespace forcelayer::voxplan {

// Moves the poses between the first and the last, and others put between them, to where the proven
// clearance is larger, as far as the stored distances tell it. Every motion keeps the clearance
// that is required, and no pose comes nearer than it was. Errors: those of PoseCheck::create().
Result<Way> widened(const Problem& problem, const Way& way, std::uint64_t seed);

// The same way as a hand would feel it: its poses moved to the middle of their neighbors, where
// none comes nearer than the nearest of the three was, and its corners cut again and again. Behind
// its first pose it goes straight on as the way out of the seat came. Every motion keeps the
// clearance that is required. Errors: those of PoseCheck::create().
Result<Way> smoothed(const Problem& problem, const Way& in_seat, const Way& way);

// Poses of the part (world_from_part) over time: its points go at `speed_mps` or less.
std::vector<PathRow> rows_of(const Problem& problem, const Way& in_seat, const Way& beyond,
                             double speed_mps);

// The verdict of voxcheck: kInSeat with the start as seat, which is clear where shell points feel
// nothing; kClear without a seat.
Result<clearance::CheckResult> proven(const Problem& problem, const std::vector<PathRow>& rows,
                                      Rule rule, unsigned threads);

}  // namespace forcelayer::voxplan

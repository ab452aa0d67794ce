// A path that was found: moved away from the scene, given times, and proven.
#pragma once

#include <vector>

#include "formats/path/path_file.h"
#include "formats/result.h"
#include "runtime/clearance/path_check.h"
#include "workbench/voxplan/check/pose_check.h"
#include "workbench/voxplan/check/problem.h"
#include "workbench/voxplan/search.h"

namespace forcelayer::voxplan {

// Moves the poses between the first and the last, and poses added between them, to where the proven
// clearance is larger, as far as the distances are stored. Every motion keeps the required
// clearance, and no pose comes nearer to the scene. Errors: those of PoseCheck::create().
Result<PosePath> widened(const Problem& problem, const PosePath& path, std::uint64_t seed);

// Poses of the part (world_from_part) over time. No point of the part is faster than `speed_mps`.
std::vector<PathRow> rows_of(const Problem& problem, const PosePath& in_seat,
                             const PosePath& beyond, double speed_mps);

// The verdict of voxcheck. With kInSeat the start is the seat, which is clear if shell points feel
// nothing. With kClear there is no seat.
Result<clearance::CheckResult> proven(const Problem& problem, const std::vector<PathRow>& rows,
                                      Rule rule, unsigned threads);

}  // namespace forcelayer::voxplan

// Makes a path smooth, so that a hand can follow it.
#pragma once

#include <vector>

#include "formats/result.h"
#include "workbench/voxplan/check/problem.h"

namespace forcelayer::voxplan {

struct PlannedPath {
  PosePath in_seat;  // up to the first pose of `beyond`; empty if that is the start
  PosePath beyond;
};

// Variants of a path, the smoothest first, the path itself last. Every motion keeps its rule: that
// of the seat, or the clearance beyond the seat. There no pose comes nearer to the scene than the
// nearest pose of the piece that it replaces, and it keeps most of its clearance. The caller takes
// the first variant that is proven clear as a whole. Errors: those of PoseCheck::create().
Result<std::vector<PlannedPath>> smoothed(const Problem& problem, const PlannedPath& path);

}  // namespace forcelayer::voxplan

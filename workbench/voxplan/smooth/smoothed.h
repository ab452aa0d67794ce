// A way that was found, as a hand would feel it.
#pragma once

#include <vector>

#include "formats/result.h"
#include "workbench/voxplan/check/problem.h"

namespace forcelayer::voxplan {

struct WholeWay {
  Way in_seat;  // up to the first pose of `beyond`; empty where that is the start
  Way beyond;
};

// Ways along the same one, the smoothest first, it itself last. Every motion keeps its rule: that
// of the seat, or beyond it the clearance. Beyond the seat no pose comes nearer than the nearest of
// those whose stretch it replaces, and keeps most of its clearance. Whether a way proves clear as a
// whole is not settled here: the first that does is to be taken. Errors: those of
// PoseCheck::create().
Result<std::vector<WholeWay>> smoothed(const Problem& problem, const WholeWay& way);

}  // namespace forcelayer::voxplan

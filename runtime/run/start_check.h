// Where a part starts: overlaps that its shell cannot feel are told before anything moves.
#pragma once

#include "forcelayer/pose.h"
#include "formats/result.h"
#include "runtime/model/simulation.h"

namespace forcelayer {

// Error kUsage where an object of the scene lies inside the part, clear of its surface, and is none
// of the seat's (runtime/query/enclosed_object.h). A part inside an object is found by
// Simulation::find_seat().
Status check_start(const model::Simulation& simulation, const Pose& world_from_center);

}  // namespace forcelayer

// The check of a part's start, before anything moves, for an overlap that its shell cannot feel.
#pragma once

#include "forcelayer/pose.h"
#include "formats/result.h"
#include "runtime/model/simulation.h"

namespace forcelayer {

// Error kUsage where an object of the scene lies wholly inside the part and is not of the seat
// (runtime/query/enclosed_object.h). Simulation::find_seat() finds the other case, a part inside an
// object.
Status check_start(const model::Simulation& simulation, const Pose& world_from_center);

}  // namespace forcelayer

// Where a part that is held should be: the nearest place at which no small motion lowers the
// energy, found by trying motions and nothing else.
#pragma once

#include "runtime/coupling/coupling.h"
#include "runtime/model/simulation.h"

namespace forcelayer::stress {

struct RestPlace {
  Pose world_from_center;
  double energy_j = 0;        // of coupling and contact springs there
  double start_energy_j = 0;  // of the pose that was asked about
};

// From `start`, a pose (world_from_center) of the default model's part that is held as `target`
// says: compass search, along the three axes and about them, in steps that shrink from a quarter of
// a voxel down to a two-hundredth, over poses without a point in the interior. Slow: thousands of
// look-ups.
RestPlace nearest_rest_place(const model::Simulation& simulation,
                             const coupling::GripTarget& target, const Pose& start);

}  // namespace forcelayer::stress

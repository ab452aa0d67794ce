// The check of a part's start, before anything moves, for an overlap that its shell cannot feel.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "forcelayer/pose.h"
#include "formats/pshell.h"
#include "formats/result.h"
#include "runtime/model/simulation.h"

namespace forcelayer {

// Error kUsage where an object of the scene lies wholly inside the part and is not of the seat
// (runtime/query/enclosed_object.h). Simulation::find_seat() finds the other case, a part inside an
// object.
Status check_start(const model::Simulation& simulation, const Pose& world_from_center);

// A warning where the scene seems to hold the part itself: every shell point feels an object of the
// seat, and the distances of the scene, where it stores some, grow along the outward normals, as
// they do about the part's own surface. Along those of a part in a narrow bore they shrink.
std::optional<std::string> part_in_scene_warning(const Voxmap& voxmap, const Pshell& shell,
                                                 const Pose& world_from_center,
                                                 std::uint64_t seat_points);

}  // namespace forcelayer

// An object of the scene inside the part, clear of its surface. No shell point comes near it, so
// that neither the guard nor a clearance knows of it: surfaces are not solids.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "forcelayer/pose.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"

namespace forcelayer::query {

struct EnclosedObject {
  std::uint32_t object = 0;  // its number in the file; 0 where the file names none
  glm::dvec3 world_m{0};     // a place in it, within a voxel
};

// The first such object in the order of the map, with the part's centroid frame at
// `world_from_center`, but for those of `felt` (numbers above 0), which shell points touch; none
// where the part's mesh is not closed, and so has no inside. A place is inside where the shell
// winds round it. Objects that come within a voxel and the covering radius of the shell everywhere
// are not found. Set-up only: every brick within the part's box is looked at.
std::optional<EnclosedObject> find_enclosed_object(const Voxmap& voxmap, const Pshell& shell,
                                                   const Pose& world_from_center,
                                                   std::span<const std::uint32_t> felt = {});

}  // namespace forcelayer::query

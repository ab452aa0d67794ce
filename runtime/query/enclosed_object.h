// Finds an object of the scene that lies wholly inside the part. No shell point comes near such an
// object, so neither the guard nor a clearance notices it: they know surfaces, not solids.
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
  glm::dvec3 world_m{0};     // the center of an interior voxel of it
};

// So many bricks take some minutes.
inline constexpr std::uint64_t kMaxSearchedBricks = std::uint64_t{1} << 26;

// The first such object in the order of the map, with the part's centroid frame at
// `world_from_center`. Objects in `felt` (numbers above 0) do not count: shell points touch them.
// Nothing where the part's mesh is not closed, because it then has no inside. A place counts as
// inside where the shell's winding number is above 1/2. An object that stays within a voxel and the
// covering radius of the shell is not found. Set-up only: looks at every brick in the part's box, a
// microsecond or more each. An error where they are more than `max_bricks`: equal bricks are stored
// once, so a small file can have more of them than anyone can look at.
Result<std::optional<EnclosedObject>> find_enclosed_object(
    const Voxmap& voxmap, const Pshell& shell, const Pose& world_from_center,
    std::span<const std::uint32_t> felt = {}, std::uint64_t max_bricks = kMaxSearchedBricks);

}  // namespace forcelayer::query

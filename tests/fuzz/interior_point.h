// The part's points against the scene's voxels, one at a time: the slow twin of the contact query.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/gtc/quaternion.hpp>

#include "forcelayer/pose.h"
#include "formats/pshell.h"
#include "formats/voxmap.h"

namespace forcelayer::test {

// Whether some point of the shell is in an interior voxel. A point within a thousandth of a voxel
// of a face counts as outside: a rounding of single precision away, the query may find the next.
inline bool has_interior_point(const Voxmap& map, const PshellView& shell,
                               const Pose& world_from_center) {
  const double s = map.voxel_size_m();
  for (std::size_t i = 0; i < shell.point_count; ++i) {
    const glm::dvec3 p =
        world_from_center.position_m +
        world_from_center.orientation * glm::dvec3(shell.x[i], shell.y[i], shell.z[i]);
    bool at_face = false;
    for (int axis = 0; axis < 3; ++axis) {
      const double within = p[axis] / s - std::floor(p[axis] / s);
      at_face = at_face || within < 1e-3 || within > 1 - 1e-3;
    }
    if (at_face) continue;
    const auto at = [&](int axis) { return static_cast<std::int64_t>(std::floor(p[axis] / s)); };
    if (map.value(at(0), at(1), at(2)) == VoxelValue::kInterior) return true;
  }
  return false;
}

}  // namespace forcelayer::test

// The coupling's angle as a continuous function of the motion, past half a turn.
#pragma once

#include "runtime/pose.h"

namespace forcelayer {

// Rotation vector (rad, world axes) that turns the part to its target: of the two of up to a whole
// turn that do, the one nearer to `last`, that of the frame before. So a part that is held while
// the hand turns on past pi is still pulled back the way it came.
glm::dvec3 continuous_angle(const Pose& world_from_center, const Pose& world_from_target,
                            const glm::dvec3& last) noexcept;

}  // namespace forcelayer

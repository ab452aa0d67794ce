// A part that is shut in: a closed surface of one object lies all around it. However the part
// moves, it stays inside as long as surfaces do not pass through each other.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>

#include "forcelayer/pose.h"
#include "workbench/exact/surface/surfaces.h"

namespace forcelayer::exact {

// The object of `scene` (in the world) that encloses `part` (about its centroid) at a pose: one of
// its connected pieces is closed, winds around the part and is more than `margin_m` away from it.
// Cracks count as open. None where there is no such object.
std::optional<std::uint32_t> enclosing_object(const Surface& scene, const Surface& part,
                                              const Pose& world_from_center, double margin_m);

// How far the part can go straight along the axes of the world before it meets the scene, m: the
// farthest of the six directions, to a micrometer. At most `longest_m`.
double farthest_straight_m(const Surface& scene, const Surface& part, const Pose& world_from_center,
                           double longest_m);

}  // namespace forcelayer::exact

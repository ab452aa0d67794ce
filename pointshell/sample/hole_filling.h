// Adding points where the proof of a covering fails, until it succeeds.
#pragma once

#include <span>
#include <vector>

#include "pointshell/certificate/certificate.h"
#include "pointshell/part/part.h"
#include "pointshell/part/vec3.h"

namespace forcelayer {

// The deepest holes, at least `separation` (m) apart from each other, as stored positions.
std::vector<Vec3> deepest_holes(std::vector<Hole> holes, double separation);

// Appends points on the surface to `points` until prove_covering succeeds at `radius`; returns the
// proof. It ends, because every point added is about `radius` away from all others.
CoveringProof fill_holes(const Part& part, double radius, std::vector<Vec3>& points);

}  // namespace forcelayer

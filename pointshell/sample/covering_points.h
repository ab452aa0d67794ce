// The `surface` method: few points on the surface whose balls cover it.
#pragma once

#include <vector>

#include "pointshell/certificate/certificate.h"
#include "pointshell/part/parallel.h"
#include "pointshell/part/triangle_tree.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::sample {

enum class Effort { kFast, kFull };

struct CoveringPoints {
  std::vector<part::Vec3> positions;  // on the surface, rounded as they are stored
  certificate::CoveringProof proof;   // that they cover the part
};

// Points on the surface of `tree`'s part that provably cover it within `radius` (m).
//
// Hexagonal fronts spread slightly fewer points than are needed. Steps to the cells' centroids even
// them out; steps to the centers of the smallest balls around the cells shrink the largest cells.
// Then, round by round, points are added in the deepest holes, far from each other, and points near
// a hole are relaxed again. Last, points are added wherever the proof finds a hole.
// `progress` is called with the fraction of the work done, in [0, 1].
CoveringPoints covering_points(const part::TriangleTree& tree, double radius, Effort effort,
                               const part::Progress& progress);

}  // namespace forcelayer::sample

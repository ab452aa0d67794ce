// The claim of a triangle: the places to which it can be the nearest of its surface. They lie
// straight above and below it, and beside that only as far as the surface around it bends away. So
// most triangles near a cell need not be measured there.
//
// Lengths in voxels. Let x be the point of the triangle t nearest to a place v, at the distance d,
// and let no other triangle be nearer than d - 2 eps. Then |v - y|^2 >= d^2 - 4 eps d for every
// point y of the surface. Let the surface around x be a graph over t's plane that falls off by at
// most `slope`. Take as y the point of that graph over x plus a step of kClaimStep towards the foot
// of v on the plane. It follows that the foot lies at most
//
//     slope |height| + kClaimStep + 2 eps d / kClaimStep
//
// beside t (slope <= 1). The surface is such a graph around every x on t except near open edges and
// corners of t. An edge or corner is open where the surface ends, is not a manifold or bends too
// much, or where the triangles are too small for the step.
#pragma once

#include <cstdint>
#include <vector>

#include "voxelize/scan/snap.h"

namespace forcelayer::distance {

// The claim of one triangle. Its corners are counted from the lowest by x, y and z, as those of
// PreparedTriangle.
struct Claim {
  std::uint8_t slope = 0;  // 1/128
  // Bits 0 to 2: the edge between corners 0 and 1, 0 and 2, 1 and 2 is open. Bits 3 to 5: corner 0,
  // 1, 2 is open. The claim holds only where the nearest point is not on an open edge and at least
  // kOpenRadiusVoxels from an open corner.
  std::uint8_t open = kAllOpen;

  static constexpr std::uint8_t kAllOpen = 63;
};

inline constexpr float kClaimStepVoxels = 1.0f / 16, kOpenRadiusVoxels = 1;

// The part of the bound above that does not depend on the height, for places up to `reach_voxels`
// from the triangle. It allows for twice the error of the kernels.
constexpr float claim_margin_voxels(float reach_voxels) {
  constexpr float kError = 2e-4f;
  return kClaimStepVoxels + 2 * kError * (reach_voxels + 1) / kClaimStepVoxels;
}

// The claims of an object's triangles: [triangles].
std::vector<Claim> claims_of(const scan::SnappedObject& object);

}  // namespace forcelayer::distance

// Where a triangle of a surface can be nearest: straight above or below itself, and beside that as
// far as the surface around it bends away. So most triangles that are near a cell need not be
// measured there.
//
// Lengths in voxels. Let x be the nearest point of the triangle t to a place v, at the distance d,
// and let no other triangle be nearer than d - 2 eps. For every point y of the surface then
// |v - y|^2 >= d^2 - 4 eps d. Where the surface around x is a graph over t's plane that falls off
// by `slope` at most, let y be the point of the graph above x plus a step of kClaimStep towards v's
// foot on the plane: the foot lies at most
//
//     slope |height| + kClaimStep + 2 eps d / kClaimStep
//
// beside t (slope <= 1). Such a graph is there at every x on t but near its open edges and corners:
// the surface ends there, is not a manifold, or bends by too much; or triangles are too small for
// the step.
#pragma once

#include <cstdint>
#include <vector>

#include "voxelize/scan/snap.h"

namespace forcelayer::distance {

// The claim of one triangle. Its corners are counted from the lowest by x, y and z, as those of
// PreparedTriangle.
struct Claim {
  std::uint8_t slope = 0;  // 1/128
  // Bits 0 to 2: the edge between corners 0 and 1, 0 and 2, 1 and 2 is open; bits 3 to 5: corner 0,
  // 1, 2. The nearest point must be off an open edge, and kOpenRadius from an open corner.
  std::uint8_t open = kAllOpen;

  static constexpr std::uint8_t kAllOpen = 63;
};

inline constexpr float kClaimStepVoxels = 1.0f / 16, kOpenRadiusVoxels = 1;

// Beside a triangle, of places up to `reach_voxels` from it. Twice the error of the kernels is
// allowed for.
constexpr float claim_margin_voxels(float reach_voxels) {
  constexpr float kError = 2e-4f;
  return kClaimStepVoxels + 2 * kError * (reach_voxels + 1) / kClaimStepVoxels;
}

// [triangles]
std::vector<Claim> claims_of(const scan::SnappedObject& object);

}  // namespace forcelayer::distance

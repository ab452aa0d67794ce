// Whether a place near a closed surface is behind it: decided by the surface, whatever the voxels.
// The angle-weighted normal at the nearest point of a closed surface points to the outside
// (Baerentzen and Aanaes, "Signed distance computation using the angle weighted pseudonormal",
// 2005).
#pragma once

#include "voxelize/distance/triangle_search.h"

namespace forcelayer::distance {

// Whether triangles are of more than one component, or of open surfaces of several objects.
inline bool are_mixed(TriangleList list) {
  return std::any_of(list.begin(), list.end(), [&](const PreparedTriangle* t) {
    return t->object != list[0]->object || !t->side.is_with(list[0]->side);
  });
}

// Triangles that may be the nearest to a place.
struct NearTriangles {
  TriangleList list;
  bool are_mixed;
};

// Whether a place, in lattice units from the lowest corner of `node`, is behind a closed component
// of an object (SurfaceSides) that is nearest to it: that of `nearest`, its nearest triangle, or
// another one that is as near, up to kKernelErrorVoxels. `away` is the vector
// from the nearest point to the place (way_from). `near` holds all triangles that are as near.
// False where the normals of triangles that touch each other cancel out.
bool is_behind(const SceneTriangles& scene, const scan::NodeIndex& node,
               const std::array<double, 3>& place, const std::array<double, 3>& away,
               const PreparedTriangle& nearest, const NearTriangles& near);

}  // namespace forcelayer::distance

// Leaves out the triangles of a swept mesh that no point outside can be near.
#pragma once

#include <string>

#include "formats/mesh/mesh.h"
#include "formats/result.h"

namespace forcelayer::sweep {

// Removes the triangles of `mesh` (world, m) all of whose voxels are farther than two voxels from
// the space that a flood from outside reaches. The flood reaches the same voxels without them, and
// no center in one of these is nearer to a removed triangle than to all others: the straight line
// from there to the removed one leaves the flooded voxels through a voxel with a triangle that
// stays. It goes on for two voxels at least, and each point of that voxel is within sqrt(3).
// Vertices stay. Errors: those of scan::snap_object() and limits::fit_directory().
Status drop_inner_triangles(mesh::Mesh& mesh, double voxel_size_m, const std::string& name);

}  // namespace forcelayer::sweep

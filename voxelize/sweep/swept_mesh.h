// The boundary of the space that a moving part sweeps, as a triangle mesh.
//
// The part is placed at sub-poses of its path. From one sub-pose to the next, each corner of a
// triangle is taken to move in a straight line. So each triangle sweeps a prism, which is cut into
// three tetrahedra in such a way that neighboring prisms share their faces. The union of all
// tetrahedra is the swept space, up to SweptMesh::deviation_m. A face that has a tetrahedron of
// nonzero volume on each side lies inside the union. All other faces are kept, with the triangles
// of the first and of the last pose. So the kept faces contain the boundary of the swept space. Of
// a straight motion, only the two ends and the silhouette between them are left.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/path/path_file.h"
#include "formats/result.h"

namespace forcelayer::sweep {

struct SweptMesh {
  mesh::Mesh mesh;  // world, m; the vertices lie on the lattice of the voxel size
  // At every time of the path, each point of the part is at most this far from the union.
  double deviation_m = 0;
  std::uint64_t poses = 0;  // sub-poses
};

// Sweeps `part` (part frame, m) along `rows`, which are poses world_from_part. Between two rows
// `center_m` moves in a straight line. `name` names the part in errors. Errors: kUsage for a path
// of one row, kBakeTooLarge where there are too many sub-poses or triangles, because the part is
// large or turns far, kSceneInvalid beyond the lattice.
Result<SweptMesh> sweep_mesh(const mesh::Mesh& part, std::span<const PathRow> rows,
                             const mesh::Vec3d& center_m, double voxel_size_m,
                             const std::string& name);

}  // namespace forcelayer::sweep

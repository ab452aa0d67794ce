// A scene whose objects are swept along a path: each becomes the mesh of the space that it sweeps.
#pragma once

#include <span>

#include "formats/mesh/scene.h"
#include "formats/path/path_file.h"
#include "formats/result.h"
#include "voxelize/cache/mesh_source.h"

namespace forcelayer::sweep {

struct SweptScene {
  std::uint64_t poses = 0;  // sub-poses of the object that needs the most
  double deviation_m = 0;   // largest SweptMesh::deviation_m, with that of the center
};

// Moves all objects of `scene` along `rows` as one rigid part, whose frame is that of the scene,
// and replaces each by the space that it sweeps, in `meshes` too. The deviation of each object
// grows by that of its sweep. `keeps_inner_triangles`: a free seed may open an enclosed space.
// Errors: kUsage where the path turns far from row to row and motion_center() does not know the
// center well enough, and those of sweep_mesh(), drop_inner_triangles() and MeshSource::mesh().
Result<SweptScene> sweep_scene(mesh::Scene& scene, cache::MeshSource& meshes,
                               std::span<const PathRow> rows, double voxel_size_m,
                               bool keeps_inner_triangles);

}  // namespace forcelayer::sweep

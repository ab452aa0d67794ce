#include "voxelize/sweep/swept_scene.h"

#include <algorithm>
#include <vector>

#include "voxelize/sweep/inner_triangles.h"
#include "voxelize/sweep/swept_mesh.h"

namespace forcelayer::sweep {

Result<SweptScene> sweep_scene(mesh::Scene& scene, cache::MeshSource& meshes,
                               std::span<const PathRow> rows, double voxel_size_m,
                               bool keeps_inner_triangles) {
  std::vector<mesh::Mesh> parts;
  for (const mesh::MeshObject& object : scene.objects) {
    const auto mesh = meshes.mesh(object);
    if (!mesh) return mesh.error();
    mesh::Mesh& part = parts.emplace_back(**mesh);
    for (mesh::Vec3d& vertex : part.vertices) {
      vertex = mesh::apply(object.world_from_mesh, vertex);
    }
  }
  const mesh::Vec3d center_m = motion_center_m(parts);
  SweptScene facts;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    mesh::MeshObject& object = scene.objects[i];
    auto swept = sweep_mesh(parts[i], rows, center_m, voxel_size_m, object.name);
    if (!swept) return swept.error();
    parts[i] = {};
    // A free seed opens a space that the flood from outside does not reach.
    if (!keeps_inner_triangles && object.free_seeds_m.empty()) {
      const Status dropped = drop_inner_triangles(swept->mesh, voxel_size_m, object.name);
      if (!dropped) return dropped.error();
    }
    facts.poses = std::max(facts.poses, swept->poses);
    facts.deviation_m = std::max(facts.deviation_m, swept->deviation_m);
    object.deviation_m += swept->deviation_m;
    object.world_from_mesh = {};
    object.box_m = mesh::box_of(swept->mesh, {});
    object.assembly = meshes.add(std::move(swept->mesh));
    object.mesh = 0;
    scene.assemblies.resize(object.assembly + 1);
    scene.assemblies.back().meshes.resize(1);
  }
  return facts;
}

}  // namespace forcelayer::sweep

#include "voxelize/sweep/swept_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "formats/path/path_edit.h"
#include "voxelize/sweep/inner_triangles.h"
#include "voxelize/sweep/motion_center.h"
#include "voxelize/sweep/swept_mesh.h"

namespace forcelayer::sweep {
namespace {

// How far the motion may be off because the center is not known, in voxels.
constexpr double kCenterVoxels = 0.1;

// Between two rows a point at the distance r from a point that moves in a straight line leaves its
// own straight line by at most r turn^2 / 8. So much are the motions about both points apart.
Result<double> deviation_of_center_m(const MotionCenter& center, std::span<const PathRow> rows,
                                     double voxel_size_m) {
  const double turn_rad = path_facts(rows).max_turn_rad;
  const double deviation_m = center.uncertainty_m * turn_rad * turn_rad / 8;
  if (deviation_m <= kCenterVoxels * voxel_size_m) return deviation_m;
  constexpr double kDegreeRad = std::numbers::pi / 180;
  char what[200], mend[200];
  std::snprintf(what, sizeof what,
                "turns by up to %.3g degrees from row to row, about a center that is not certain: "
                "the part's meshes are not all closed surfaces that face outward",
                turn_rad / kDegreeRad);
  std::snprintf(
      mend, sizeof mend,
      "mend the meshes, or add rows at most %.2g degrees apart with voxinfo path "
      "--resample --part",
      std::sqrt(8 * kCenterVoxels * voxel_size_m / center.uncertainty_m) / kDegreeRad * 0.95);
  return Error{ErrorCode::kUsage, "", "", what, mend};
}

}  // namespace

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
  const MotionCenter center = motion_center(parts);
  const auto of_center_m = deviation_of_center_m(center, rows, voxel_size_m);
  if (!of_center_m) return of_center_m.error();
  SweptScene facts;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    mesh::MeshObject& object = scene.objects[i];
    auto swept = sweep_mesh(parts[i], rows, center.at_m, voxel_size_m, object.name);
    if (!swept) return swept.error();
    parts[i] = {};
    // A free seed opens a space that the flood from outside does not reach.
    if (!keeps_inner_triangles && object.free_seeds_m.empty()) {
      const Status dropped = drop_inner_triangles(swept->mesh, voxel_size_m, object.name);
      if (!dropped) return dropped.error();
    }
    facts.poses = std::max(facts.poses, swept->poses);
    const double deviation_m = swept->deviation_m + *of_center_m;
    facts.deviation_m = std::max(facts.deviation_m, deviation_m);
    object.deviation_m += deviation_m;
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

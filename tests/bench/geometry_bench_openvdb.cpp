#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <cmath>

#include "tests/bench/bench_report.h"
#include "tests/bench/geometry_bench_voxels.h"

namespace forcelayer::bench {

VoxelRun mesh_to_volume_voxels(const mesh::Mesh& mesh, double threshold) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& v : mesh.vertices) {  // its voxel i is centered at i, ours at i + 1/2
    points.emplace_back(openvdb::Vec3d(v[0] - 0.5, v[1] - 0.5, v[2] - 0.5));
  }
  for (const mesh::Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(
      points, triangles);
  const auto transform = openvdb::math::Transform::createLinearTransform(1);
  VoxelRun run;
  const double wall_s = now_s(), cpu_start_s = cpu_s();
  const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
      adapter, *transform, 1, 1, openvdb::tools::UNSIGNED_DISTANCE_FIELD);
  run.wall_s = now_s() - wall_s;
  run.cpu_s = cpu_s() - cpu_start_s;
  run.peak_rss_bytes = peak_rss_bytes();
  for (auto value = grid->cbeginValueOn(); value; ++value) {
    if (*value > threshold) continue;
    const openvdb::Coord c = value.getCoord();
    run.voxels.push_back({c.x(), c.y(), c.z()});
  }
  return run;
}

}  // namespace forcelayer::bench

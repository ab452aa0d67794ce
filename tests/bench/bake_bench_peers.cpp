#include "tests/bench/bake_bench_peers.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/bench/bench_report.h"
#include "voxelize/mask_tree.h"
#include "voxelize/scan_conversion.h"
#include "voxelize/snap.h"

namespace forcelayer::bench {
namespace {

using Point = openvdb::Vec3d;
using PeerTree = openvdb::tree::Tree4<openvdb::ValueMask, 3, 3, 3>::Type;

// The set-up of Schwarz and Seidel for one triangle against unit cubes.
class TriangleBoxTest {
 public:
  TriangleBoxTest(const Point& a, const Point& b, const Point& c) : corner_(a) {
    const Point corners[3] = {a, b, c};
    const Point edges[3] = {b - a, c - b, a - c};
    normal_ = edges[0].cross(edges[1]);
    const Point critical(normal_[0] > 0, normal_[1] > 0, normal_[2] > 0);
    near_ = normal_.dot(critical - a);
    far_ = normal_.dot((Point(1) - critical) - a);
    for (int d = 0; d < 3; ++d) {
      const int u = (d + 1) % 3, w = (d + 2) % 3;
      const double sign = normal_[d] >= 0 ? 1 : -1;
      for (int k = 0; k < 3; ++k) {
        Edge& edge = edges_[d][k];
        edge.u = -edges[k][w] * sign;
        edge.w = edges[k][u] * sign;
        edge.offset = -(edge.u * corners[k][u] + edge.w * corners[k][w]) + std::max(0.0, edge.u) +
                      std::max(0.0, edge.w);
      }
    }
  }

  bool overlaps(const Point& low) const {
    const double value = normal_.dot(low);
    if ((value + near_) * (value + far_) > 0) return false;
    for (int d = 0; d < 3; ++d) {
      const double u = low[(d + 1) % 3], w = low[(d + 2) % 3];
      for (const Edge& edge : edges_[d]) {
        if (edge.u * u + edge.w * w + edge.offset < 0) return false;
      }
    }
    return true;
  }

 private:
  struct Edge {
    double u, w, offset;
  };
  Point corner_, normal_;
  double near_, far_;
  Edge edges_[3][3];
};

Point vertex(const Mesh& mesh, std::uint32_t index) { return Point(mesh.vertices[index].data()); }

template <class Accessor>
void mark(const Point& a, const Point& b, const Point& c, Accessor& accessor) {
  const TriangleBoxTest test(a, b, c);
  openvdb::Coord low, high;
  for (int d = 0; d < 3; ++d) {
    low[d] = static_cast<int>(std::floor(std::min({a[d], b[d], c[d]})));
    high[d] = static_cast<int>(std::floor(std::max({a[d], b[d], c[d]})));
  }
  for (int x = low[0]; x <= high[0]; ++x) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int z = low[2]; z <= high[2]; ++z) {
        if (test.overlaps(Point(x, y, z))) accessor.setValueOn(openvdb::Coord(x, y, z));
      }
    }
  }
}

}  // namespace

PeerRun run_scan_conversion(const Mesh& mesh, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  PeerRun run;
  const double wall_s = now_s(), cpu_start_s = cpu_s();
  const auto object = snap_object(mesh, Affine{}, 1, "bench");
  if (!object) throw std::runtime_error(to_line(object.error()));
  const auto tree = scan_convert(*object, {0, 0, 0});
  run.wall_s = now_s() - wall_s;
  run.cpu_s = cpu_s() - cpu_start_s;
  run.voxels = voxel_count(*tree);
  return run;
}

PeerRun run_mesh_to_volume(const Mesh& mesh) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& v : mesh.vertices) points.emplace_back(openvdb::Vec3d(v.data()));
  for (const Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(
      points, triangles);
  const auto transform = openvdb::math::Transform::createLinearTransform(1);
  PeerRun run;
  const double wall_s = now_s(), cpu_start_s = cpu_s();
  const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(adapter, *transform, 3, 3);
  run.wall_s = now_s() - wall_s;
  run.cpu_s = cpu_s() - cpu_start_s;
  run.voxels = grid->activeVoxelCount();
  return run;
}

PeerRun run_straightforward(const Mesh& mesh) {
  PeerRun run;
  const double wall_s = now_s(), cpu_start_s = cpu_s();
  PeerTree tree;
  openvdb::tree::ValueAccessor<PeerTree> accessor(tree);
  for (const Triangle& t : mesh.triangles) {
    mark(vertex(mesh, t[0]), vertex(mesh, t[1]), vertex(mesh, t[2]), accessor);
  }
  run.wall_s = now_s() - wall_s;
  run.cpu_s = cpu_s() - cpu_start_s;
  run.voxels = tree.activeVoxelCount();
  return run;
}

}  // namespace forcelayer::bench

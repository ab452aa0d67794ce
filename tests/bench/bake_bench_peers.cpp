#include "tests/bench/bake_bench_peers.h"

#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "tests/bench/bench_report.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/scan/scan_conversion.h"
#include "voxelize/scan/snap.h"

namespace forcelayer::bench {
namespace {

using PeerTree = openvdb::tree::Tree4<openvdb::ValueMask, 3, 3, 3>::Type;
__extension__ typedef __int128 Int128;

// The set-up of Schwarz and Seidel for one triangle against half-open unit cubes, in integers; Int
// must hold the cube of the triangle's extent (units of 2^-10 voxel).
template <class Int>
class TriangleBoxTest {
 public:
  // Corners relative to the lowest voxel of their box.
  explicit TriangleBoxTest(const lattice::LatticeTriangle& corners) {
    std::array<std::array<Int, 3>, 3> sides;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t d = 0; d < 3; ++d) sides[k][d] = corners[(k + 1) % 3][d] - corners[k][d];
    }
    Int value = 0, up = 0, down = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      const std::size_t u = (d + 1) % 3, w = (d + 2) % 3;
      normal_[d] = sides[0][u] * sides[1][w] - sides[0][w] * sides[1][u];
      value += normal_[d] * corners[0][d];
      (normal_[d] > 0 ? up : down) += normal_[d] * lattice::kSnapUnits;
      for (std::size_t k = 0; k < 3; ++k) {
        edges_[d][k] = edge(-sides[k][w], sides[k][u], corners[k], u, w, normal_[d] < 0);
      }
      if (normal_[d] != 0) continue;
      // A shadow without area is a segment: its line bounds it from both sides.
      const std::size_t line = sides[0][u] == 0 && sides[0][w] == 0 ? 1 : 0;
      const Int a = -sides[line][w], b = sides[line][u];
      edges_[d] = {edge(a, b, corners[0], u, w, false), edge(a, b, corners[0], u, w, true), {}};
    }
    least_ = value - up + (up > 0 ? 1 : 0);
    greatest_ = value - down - (down < 0 ? 1 : 0);
  }

  bool overlaps(const std::array<std::int64_t, 3>& voxel) const {
    std::array<Int, 3> low;
    for (std::size_t d = 0; d < 3; ++d) low[d] = voxel[d] * lattice::kSnapUnits;
    const Int value = normal_[0] * low[0] + normal_[1] * low[1] + normal_[2] * low[2];
    if (value < least_ || value > greatest_) return false;
    for (std::size_t d = 0; d < 3; ++d) {
      const Int u = low[(d + 1) % 3], w = low[(d + 2) % 3];
      for (const Edge& e : edges_[d]) {
        if (e.a * u + e.b * w < e.least) return false;
      }
    }
    return true;
  }

 private:
  struct Edge {
    Int a = 0, b = 0, least = 0;  // a cube at (u, w) passes where a u + b w >= least
  };
  // The half-plane a (u - u0) + b (w - w0) >= 0, or its opposite. A cube reaches up by a and b
  // where these are positive, but its far faces are not its own.
  static Edge edge(Int a, Int b, const lattice::LatticePoint& through, std::size_t u, std::size_t w,
                   bool turned) {
    if (turned) a = -a, b = -b;
    const Int reach = (a > 0 ? a : Int{0}) + (b > 0 ? b : Int{0});
    return {a, b,
            a * through[u] + b * through[w] - reach * lattice::kSnapUnits + (reach > 0 ? 1 : 0)};
  }

  std::array<Int, 3> normal_;
  Int least_, greatest_;
  std::array<std::array<Edge, 3>, 3> edges_;
};

template <class Int, class Accessor>
void mark(const lattice::LatticeTriangle& triangle, const lattice::VoxelIndex& low,
          const lattice::VoxelIndex& high, Accessor& accessor) {
  lattice::LatticeTriangle corners = triangle;
  for (auto& corner : corners) {
    for (std::size_t d = 0; d < 3; ++d) corner[d] -= low[d] * lattice::kSnapUnits;
  }
  const TriangleBoxTest<Int> test(corners);
  for (std::int64_t x = low[0]; x <= high[0]; ++x) {
    for (std::int64_t y = low[1]; y <= high[1]; ++y) {
      for (std::int64_t z = low[2]; z <= high[2]; ++z) {
        if (test.overlaps({x - low[0], y - low[1], z - low[2]})) {
          accessor.setValueOn(
              openvdb::Coord(static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)));
        }
      }
    }
  }
}

}  // namespace

PeerRun run_scan_conversion(const mesh::Mesh& mesh, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  PeerRun run;
  const double wall_s = now_s(), cpu_start_s = cpu_s();
  const auto object = scan::snap_object(mesh, mesh::Affine{}, 1, "bench");
  if (!object) throw std::runtime_error(to_line(object.error()));
  const auto tree = scan::scan_convert(*object, {0, 0, 0});
  run.wall_s = now_s() - wall_s;
  run.cpu_s = cpu_s() - cpu_start_s;
  run.voxels = masks::voxel_count(*tree);
  return run;
}

PeerRun run_mesh_to_volume(const mesh::Mesh& mesh, float exterior, float interior) {
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& v : mesh.vertices) points.emplace_back(openvdb::Vec3d(v.data()));
  for (const mesh::Triangle& t : mesh.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> adapter(
      points, triangles);
  const auto transform = openvdb::math::Transform::createLinearTransform(1);
  PeerRun run;
  const double wall_s = now_s(), cpu_start_s = cpu_s();
  const auto grid =
      openvdb::tools::meshToVolume<openvdb::FloatGrid>(adapter, *transform, exterior, interior);
  run.wall_s = now_s() - wall_s;
  run.cpu_s = cpu_s() - cpu_start_s;
  run.voxels = grid->activeVoxelCount();
  return run;
}

PeerRun run_straightforward(const mesh::Mesh& mesh) {
  PeerRun run;
  const double wall_s = now_s(), cpu_start_s = cpu_s();
  std::vector<lattice::LatticePoint> vertices;
  vertices.reserve(mesh.vertices.size());
  for (const mesh::Vec3d& vertex : mesh.vertices) vertices.push_back(lattice::snap(vertex, 1));
  PeerTree tree;
  openvdb::tree::ValueAccessor<PeerTree> accessor(tree);
  for (const mesh::Triangle& t : mesh.triangles) {
    const lattice::LatticeTriangle triangle = {vertices[t[0]], vertices[t[1]], vertices[t[2]]};
    lattice::VoxelIndex low, high;
    std::int64_t extent = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      low[d] = std::min({triangle[0][d], triangle[1][d], triangle[2][d]}) >> lattice::kSnapBits;
      high[d] = std::max({triangle[0][d], triangle[1][d], triangle[2][d]}) >> lattice::kSnapBits;
      extent = std::max(extent, high[d] - low[d]);
    }
    constexpr std::int64_t kMaxExtent64 = 512;  // 6 (2^9 2^10)^3 < 2^63
    if (extent < kMaxExtent64) {
      mark<std::int64_t>(triangle, low, high, accessor);
    } else {
      mark<Int128>(triangle, low, high, accessor);
    }
  }
  run.wall_s = now_s() - wall_s;
  run.cpu_s = cpu_s() - cpu_start_s;
  run.voxels = tree.activeVoxelCount();
  return run;
}

}  // namespace forcelayer::bench

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "formats/lattice/voxel_overlap.h"
#include "voxelize/scan/snap.h"

namespace forcelayer {
namespace {

// A mesh far from the world's origin, brought back by its transform: where placing a vertex passes
// through large sums, their rounding counts, although the placed coordinates are small.
TEST(Snap, BoundHoldsForMeshThatItsTransformBringsBack) {
  constexpr double kVoxelSize = 1e-7, kFar = 1e7;
  std::mt19937_64 random(42);
  std::uniform_real_distribution<double> near(-1, 1);
  long double worst = 0;
  double bound = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const double angle = near(random);
    mesh::Affine world_from_mesh;
    world_from_mesh.linear = {
        std::cos(angle), -std::sin(angle), 0, std::sin(angle), std::cos(angle), 0, 0, 0, 1};
    mesh::Mesh mesh;
    for (int n = 0; n < 30; ++n) {
      mesh.vertices.push_back({kFar + near(random), kFar + near(random), near(random)});
    }
    for (std::uint32_t n = 0; n < 30; n += 3) mesh.triangles.push_back({n, n + 1, n + 2});
    const mesh::Vec3d placed = mesh::apply(world_from_mesh, {kFar, kFar, 0});
    world_from_mesh.translation = {-placed[0], -placed[1], 0};
    const auto object = scan::snap_object(mesh, world_from_mesh, kVoxelSize, "far");
    ASSERT_TRUE(object) << to_line(object.error());
    bound = object->snap_error_m;
    for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
      long double squared = 0;
      for (std::size_t d = 0; d < 3; ++d) {
        long double exact = world_from_mesh.translation[d];
        for (std::size_t e = 0; e < 3; ++e) {
          exact +=
              static_cast<long double>(world_from_mesh.linear[3 * d + e]) * mesh.vertices[n][e];
        }
        const long double snapped =
            static_cast<long double>(object->vertices[n][d]) * kVoxelSize / lattice::kSnapUnits;
        squared += (snapped - exact) * (snapped - exact);
      }
      const long double error = std::sqrt(squared);
      EXPECT_LE(error, bound) << "trial " << trial << ", vertex " << n;
      worst = std::max(worst, error);
    }
  }
  EXPECT_GT(worst, bound / 100);  // the bound is no more than two orders above what happens
}

}  // namespace
}  // namespace forcelayer

// A scene far from the origin bakes to the same voxels as one near it.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/soups.h"
#include "voxelize/bake.h"

namespace forcelayer {
namespace {

using reference::Random;
using reference::real;
using reference::whole;

// A power of two, and vertices on the lattice of 2^-10 voxel: every coordinate is exact, here and
// 1e5 m away, so that not even the snap may differ.
constexpr double kVoxelM = 1.0 / 256;
constexpr double kBlockM = 512 * kVoxelM;  // 2 m

mesh::Mesh on_lattice(Random& random) {
  mesh::Mesh mesh = reference::random_object(
      random, {real(random, -20, 20), real(random, -20, 20), real(random, -20, 20)},
      real(random, 5, 60));
  for (mesh::Vec3d& vertex : mesh.vertices) {
    for (double& x : vertex) x = std::nearbyint(x * 1024) / 1024 * kVoxelM;
  }
  return mesh;
}

TEST(FarScene, BakesToTheSameVoxelsAsNearTheOrigin) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const std::vector<mesh::Mesh> meshes = {on_lattice(random), on_lattice(random)};
    mesh::Affine far;
    std::array<std::int64_t, 3> shift_voxels;
    for (std::size_t d = 0; d < 3; ++d) {  // about 1e5 m, whole blocks
      const std::int64_t blocks = whole(random, -1, 1) * (50000 + whole(random, 0, 99));
      far.translation[d] = static_cast<double>(blocks) * kBlockM;
      shift_voxels[d] = blocks * 512;
    }
    std::vector<voxelize::SceneObject> here, there;
    for (const mesh::Mesh& mesh : meshes) {
      here.push_back({"part", &mesh, mesh::Affine{}, {}, 0});
      there.push_back({"part", &mesh, far, {}, 0});
    }
    voxelize::BakeOptions options;
    options.voxel_size_m = kVoxelM;
    const auto near_bake = voxelize::bake(here, options), far_bake = voxelize::bake(there, options);
    ASSERT_TRUE(near_bake) << to_line(near_bake.error());
    ASSERT_TRUE(far_bake) << to_line(far_bake.error());
    for (std::size_t d = 0; d < 3; ++d) {
      ASSERT_EQ(far_bake->header.origin_voxel[d],
                near_bake->header.origin_voxel[d] + shift_voxels[d]);
    }
    ASSERT_EQ(far_bake->header.dims_voxels, near_bake->header.dims_voxels);
    ASSERT_EQ(far_bake->values.directory, near_bake->values.directory);
    ASSERT_EQ(far_bake->values.upper_nodes, near_bake->values.upper_nodes);
    ASSERT_EQ(far_bake->values.lower_nodes, near_bake->values.lower_nodes);
    ASSERT_EQ(far_bake->values.bricks, near_bake->values.bricks);
    // The rounding of far coordinates in general stays far below the snap itself, and is counted.
    EXPECT_GE(far_bake->header.static_deviation_m, near_bake->header.static_deviation_m);
    EXPECT_LT(far_bake->header.static_deviation_m,
              near_bake->header.static_deviation_m + kVoxelM * 1e-4);
  }
}

}  // namespace
}  // namespace forcelayer

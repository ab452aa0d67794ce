// A triangle that no machine can hold is refused before memory is taken, with the numbers.
#include <gtest/gtest.h>

#include <cmath>

#include "voxelize/bake.h"
#include "voxelize/memory_limit.h"

namespace forcelayer {
namespace {

SnappedObject snapped(const Mesh& mesh, double voxel_size_m) {
  auto object = snap_object(mesh, {}, voxel_size_m, "plate");
  EXPECT_TRUE(object);
  return std::move(*object);
}

Mesh plate(double edge_m, bool upright = false) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {edge_m, 0, 0}, {0, edge_m, 0}, {1, 1, 1}, {1.1, 1, 1}, {1, 1.1, 1}};
  if (upright) std::swap(mesh.vertices[1][0], mesh.vertices[1][2]);
  mesh.triangles = {{3, 4, 5}, {0, 1, 2}};
  return mesh;
}

TEST(MemoryLimit, CountsTheLargestTriangle) {
  constexpr double kVoxels = 1e4 * 1e4 / 2;
  for (const bool upright : {false, true}) {
    const Mesh mesh = plate(10, upright);
    const SnappedObject object = snapped(mesh, 1e-3);
    EXPECT_TRUE(fit_memory(object, "plate", 1e-3, 1.51 * kVoxels));
    const Status refused = fit_memory(object, "plate", 1e-3, 1.49 * kVoxels);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kBakeTooLarge);
    EXPECT_EQ(refused.error().where, "triangle 1 of plate");
    EXPECT_NE(refused.error().what.find("at least 5e+07 voxels, which take 0.075 GB"),
              std::string::npos)
        << to_line(refused.error());
  }
}

TEST(MemoryLimit, NamesAVoxelSizeThatFits) {
  const Mesh mesh = plate(10);
  const Status refused = fit_memory(snapped(mesh, 1e-3), "plate", 1e-3, 1e6);
  ASSERT_FALSE(refused);
  double size_m = 0;
  const std::string& mend = refused.error().mend;
  ASSERT_EQ(std::sscanf(mend.c_str() + mend.find("--voxel-size"), "--voxel-size %lfm", &size_m), 1);
  EXPECT_TRUE(fit_memory(snapped(mesh, size_m), "plate", size_m, 1e6)) << mend;
  EXPECT_FALSE(fit_memory(snapped(mesh, 0.9 * size_m), "plate", 0.9 * size_m, 1e6)) << mend;
}

// Within the directory's limit, and some 10 TB.
TEST(MemoryLimit, HoldsInABake) {
  const Mesh mesh = plate(3000);
  SceneObject object;
  object.name = "plate";
  object.mesh = &mesh;
  BakeOptions options;
  options.voxel_size_m = 1e-3;
  options.threads = 1;
  const auto refused = bake(std::span(&object, 1), options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBakeTooLarge) << to_line(refused.error());
  EXPECT_GT(available_bytes(), 1e8);
}

}  // namespace
}  // namespace forcelayer

// A triangle that no machine can hold is refused before memory is taken, with the numbers.
#include <gtest/gtest.h>

#include <cmath>

#include "voxelize/bake.h"
#include "voxelize/limits/memory_limit.h"
#include "voxelize/masks/mask_tree.h"
#include "voxelize/scan/scan_conversion.h"

namespace forcelayer {
namespace {

scan::SnappedObject snapped(const mesh::Mesh& mesh, double voxel_size_m) {
  auto object = scan::snap_object(mesh, {}, voxel_size_m, "plate");
  EXPECT_TRUE(object);
  return std::move(*object);
}

mesh::Mesh plate(double edge_m, bool upright = false) {
  mesh::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {edge_m, 0, 0}, {0, edge_m, 0}, {1, 1, 1}, {1.1, 1, 1}, {1, 1.1, 1}};
  if (upright) std::swap(mesh.vertices[1][0], mesh.vertices[1][2]);
  mesh.triangles = {{3, 4, 5}, {0, 1, 2}};
  return mesh;
}

TEST(MemoryLimit, CountsTheLargestTriangle) {
  constexpr double kVoxels = 1e4 * 1e4 / 2;
  for (const bool upright : {false, true}) {
    const mesh::Mesh mesh = plate(10, upright);
    const scan::SnappedObject object = snapped(mesh, 1e-3);
    EXPECT_TRUE(limits::fit_memory(object, "plate", 1e-3, 1.51 * kVoxels));
    const Status refused = limits::fit_memory(object, "plate", 1e-3, 1.49 * kVoxels);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kBakeTooLarge);
    EXPECT_EQ(refused.error().where, "triangle 1 of plate");
    EXPECT_NE(refused.error().what.find("at least 5e+07 voxels, which take 0.075 GB"),
              std::string::npos)
        << to_line(refused.error());
  }
}

// An object of a meter with one vertex far away.
mesh::Mesh stray_vertex(double away_m) {
  mesh::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}, {1, 0, 0}, {0.005, 0.005, -away_m}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 4}, {1, 3, 2}};
  return mesh;
}

// The sliver covers no plane of voxels, but is a brick every 8 and a node every 64 voxels.
TEST(MemoryLimit, CountsTheLongestSliver) {
  const mesh::Mesh mesh = stray_vertex(1e4);
  const scan::SnappedObject object = snapped(mesh, 1e-2);
  const double least = 1e6 / 64 * (8 * 96 + sizeof(masks::LowerMaskNode));
  EXPECT_TRUE(limits::fit_memory(object, "part", 1e-2, 1.01 * least));
  const Status refused = limits::fit_memory(object, "part", 1e-2, 0.99 * least);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBakeTooLarge);
  EXPECT_EQ(refused.error().where, "triangle 1 of part");
  EXPECT_NE(refused.error().what.find("at least 1e+06 voxels"), std::string::npos);
  EXPECT_NE(refused.error().mend.find("stray vertex"), std::string::npos);
}

// A refused bake could not have been held: the voxels that the surface passes through, alone, take
// more than is said.
TEST(MemoryLimit, SaysLessThanTheVoxelsTake) {
  for (const double away_m : {1.0, 10.0, 100.0}) {
    for (const double voxel_size_m : {1e-2, 1e-3}) {
      const mesh::Mesh mesh = stray_vertex(away_m);
      const scan::SnappedObject object = snapped(mesh, voxel_size_m);
      const auto tree = scan::scan_convert(object, {-(1 << 20), -(1 << 20), -(1 << 20)});
      const double taken = static_cast<double>(tree->memUsage());
      EXPECT_TRUE(limits::fit_memory(object, "part", voxel_size_m, taken))
          << away_m << " " << voxel_size_m;
      // And not so much less that it were of no use.
      EXPECT_FALSE(limits::fit_memory(object, "part", voxel_size_m, taken / 8));
    }
  }
}

TEST(MemoryLimit, NamesAVoxelSizeThatFits) {
  for (const mesh::Mesh& mesh : {plate(10), stray_vertex(1e3)}) {
    const Status refused = limits::fit_memory(snapped(mesh, 1e-3), "plate", 1e-3, 1e6);
    ASSERT_FALSE(refused);
    double size_m = 0;
    const std::string& mend = refused.error().mend;
    ASSERT_EQ(std::sscanf(mend.c_str() + mend.find("--voxel-size"), "--voxel-size %lfm", &size_m),
              1);
    EXPECT_TRUE(limits::fit_memory(snapped(mesh, size_m), "plate", size_m, 1e6)) << mend;
    EXPECT_FALSE(limits::fit_memory(snapped(mesh, 0.9 * size_m), "plate", 0.9 * size_m, 1e6))
        << mend;
  }
}

// Within the directory's limit, and some 10 TB.
TEST(MemoryLimit, HoldsInABake) {
  const mesh::Mesh mesh = plate(3000);
  voxelize::SceneObject object;
  object.name = "plate";
  object.mesh = &mesh;
  voxelize::BakeOptions options;
  options.voxel_size_m = 1e-3;
  options.threads = 1;
  const auto refused = voxelize::bake(std::span(&object, 1), options);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBakeTooLarge) << to_line(refused.error());
  EXPECT_GT(limits::available_bytes(), 1e8);
}

}  // namespace
}  // namespace forcelayer

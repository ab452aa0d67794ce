// Files of format version 1.0, committed once: every later version must read them, and the writer
// must keep producing the same bytes. FORCELAYER_WRITE_GOLDEN=1 writes those that do not exist yet.
#include <gtest/gtest.h>

#include "tests/support/golden_bytes.h"
#include "tests/support/golden_content.h"

namespace forcelayer::testing {
namespace {

TEST(Golden, VoxmapBytes) {
  const DenseVoxels voxels = golden_voxels();
  expect_golden_bytes("v1.vox", voxmap_bytes(DenseTree(voxels, golden_voxmap_options()).content()));
}

TEST(Golden, WideVoxmapBytes) {
  expect_golden_bytes("v1_wide.vox", voxmap_bytes(GoldenWideVoxmap().content()));
}

TEST(Golden, PshellBytes) {
  const auto [points, normals] = golden_points();
  expect_golden_bytes("v1.pshell",
                      pshell_bytes(TestShell(points, normals, golden_shell_options()).content()));
}

TEST(Golden, VoxmapValues) {
  const auto map = Voxmap::open(golden_path("v1.vox"), Verify::kStructureAndChecksums);
  ASSERT_TRUE(map) << to_line(map.error());
  const DenseVoxels voxels = golden_voxels();
  std::int64_t wrong = 0, non_free = 0;
  for_each_voxel({{-530, -10, -20}, {-420, 80, 80}}, [&](const VoxelIndex& v) {
    const VoxelValue value = map->value(v[0], v[1], v[2]);
    wrong += value != voxels.value(v[0], v[1], v[2]);
    non_free += value != VoxelValue::kFree;
  });
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(non_free, 64 * 64 * 66 + 4);
}

TEST(Golden, VoxmapFacts) {
  const auto map = Voxmap::open(golden_path("v1.vox"));
  ASSERT_TRUE(map) << to_line(map.error());
  const VoxmapHeader& h = map->header();
  EXPECT_EQ(h.voxel_size_m, 0.0025);
  EXPECT_EQ(h.origin_voxel, (VoxelIndex{-514, 0, -8}));
  EXPECT_EQ(h.dims_voxels, (std::array<std::uint64_t, 3>{84, 70, 72}));
  EXPECT_EQ(h.valid_min_voxel, (VoxelIndex{-600, -100, -100}));
  EXPECT_EQ(h.valid_max_voxel, (VoxelIndex{-400, 200, 200}));
  EXPECT_EQ(h.cropped_sides, kCroppedMaxX);
  EXPECT_EQ(h.offset_layers, 2u);
  EXPECT_EQ(h.bits_per_voxel, 2u);
  EXPECT_EQ(h.directory_origin, (VoxelIndex{-1024, 0, -512}));
  EXPECT_EQ(h.directory_dims, (std::array<std::uint32_t, 3>{2, 1, 2}));
  EXPECT_EQ(h.interior_voxels, 64u * 64 * 64 + 1);
  EXPECT_EQ(h.surface_voxels, 64u * 64 + 2);
  EXPECT_EQ(h.proximity_voxels, 64u * 64 + 1);
  EXPECT_EQ(h.static_deviation_m, 0x1p-17 * 1.024);
  EXPECT_EQ(map->provenance(), R"({"made by":"tests/support/golden_content.h","inputs":[]})");
}

// Clearances of three free boxes, worked out by hand.
TEST(Golden, VoxmapClearances) {
  const auto map = Voxmap::open(golden_path("v1.vox"));
  ASSERT_TRUE(map) << to_line(map.error());
  const VoxmapView& view = map->view();
  const auto at = [&](int i, int j, int k) { return view.lookup(i + 1024, j, k + 512); };
  const VoxelLookup block = at(-1024, 100, 100);  // 64^3 at (-1024, 64, 64): y is 63 + 1 from it
  EXPECT_EQ(block.edge_voxels, 64u);
  EXPECT_EQ(block.clearance, 447u);         // its last x is -961, the proximity layer's x -514
  const VoxelLookup cell = at(-528, 8, 8);  // 8^3 with last x = -521
  EXPECT_EQ(cell.edge_voxels, 8u);
  EXPECT_EQ(cell.clearance, 7u);
  const VoxelLookup cropped = at(-390, 8, 8);  // beyond the cropped side x = -400: unknown
  EXPECT_EQ(cropped.code, 0u);
  EXPECT_EQ(cropped.clearance, 0u);
}

TEST(Golden, WideVoxmapCodes) {
  const auto map = Voxmap::open(golden_path("v1_wide.vox"), Verify::kStructureAndChecksums);
  ASSERT_TRUE(map) << to_line(map.error());
  const VoxmapView& view = map->view();
  for (std::int32_t n = 0; n < 512; ++n) {
    const std::int32_t x = n >> 6, y = (n >> 3) & 7, z = n & 7;
    EXPECT_EQ(view.lookup(x, y, z).code, static_cast<std::uint32_t>(n % 16));
    EXPECT_EQ(view.lookup(56 + x, 56 + y, 56 + z).code, n == 511 ? 0u : 15u);
  }
  EXPECT_EQ(view.lookup(0, 0, 8).code, 0u);
  EXPECT_EQ(view.lookup(0, 0, 8).edge_voxels, 8u);
  EXPECT_EQ(view.lookup(0, 8, 0).code, 12u);
  EXPECT_EQ(view.lookup(64, 0, 0).clearance, 1u);
  EXPECT_EQ(map->value(0, 0, 4), VoxelValue::kInterior);
  EXPECT_EQ(map->value(0, 0, 5), VoxelValue::kSurface);
  EXPECT_EQ(map->value(0, 1, 0), VoxelValue::kProximity);
  EXPECT_EQ(map->value(0, 1, 3), VoxelValue::kFree);
  ASSERT_EQ(map->compliance().size(), 4u);
  EXPECT_EQ(map->compliance()[3], 1.75f);
}

TEST(Golden, PshellValues) {
  const auto shell = Pshell::open(golden_path("v1.pshell"), Verify::kStructureAndChecksums);
  ASSERT_TRUE(shell) << to_line(shell.error());
  const auto [points, normals] = golden_points();
  const PshellView& v = shell->view();
  ASSERT_EQ(v.point_count, 100u);
  EXPECT_EQ(v.block_points, 64u);
  EXPECT_EQ(v.block_count, 2u);
  EXPECT_EQ(v.super_block_count, 2u);
  for (std::size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(v.x[i], static_cast<float>(points[i][0] - 0.5));
    EXPECT_EQ(v.y[i], static_cast<float>(points[i][1]));
    EXPECT_EQ(v.z[i], static_cast<float>(points[i][2]));
    EXPECT_EQ(v.nx[i], static_cast<float>(normals[i][0]));
    EXPECT_EQ(v.ny[i], static_cast<float>(normals[i][1]));
    EXPECT_EQ(v.nz[i], static_cast<float>(normals[i][2]));
    EXPECT_EQ(v.weight_m2[i], 0.00005f);
    EXPECT_EQ(v.cone_cos[i], 1.0f);
  }
  const PshellHeader& h = shell->header();
  EXPECT_EQ(h.voxel_size_m, 0.0025);
  EXPECT_EQ(h.covering_radius_m, 0.002);
  EXPECT_EQ(h.part_deviation_m, 0.000001);
  EXPECT_EQ(h.center_m, (std::array<double, 3>{0.5, 0, 0}));
  EXPECT_EQ(h.method, static_cast<std::uint32_t>(ShellMethod::kSurface));
}

}  // namespace
}  // namespace forcelayer::testing

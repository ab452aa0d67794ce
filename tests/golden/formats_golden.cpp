// Files of the formats' major versions, committed once: every later minor version must read them,
// and the writer must keep producing the same bytes. FORCELAYER_WRITE_GOLDEN=1 writes those that do
// not exist yet.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <sstream>

#include "formats/section_table.h"
#include "tests/support/golden_bytes.h"
#include "tests/support/golden_content.h"
#include "tests/support/places.h"

namespace forcelayer::testing {
namespace {

TEST(Golden, VoxmapBytes) {
  const DenseVoxels voxels = golden_voxels();
  expect_golden_bytes("v2.vox", voxmap_bytes(DenseTree(voxels, golden_voxmap_options()).content()));
}

TEST(Golden, DistanceBytes) {
  expect_golden_bytes("v2_distances.vox", voxmap_bytes(GoldenDistances().content()));
}

TEST(Golden, PshellBytes) {
  const auto [points, normals] = golden_points();
  expect_golden_bytes("v2.pshell",
                      pshell_bytes(TestShell(points, normals, golden_shell_options()).content()));
}

// Version 2.1: every third point of the same shell has no inside.
TestShellOptions two_sided_golden_options() {
  TestShellOptions options = golden_shell_options();
  for (std::size_t i = 0; i < 100; ++i) options.two_sided.push_back(i % 3 == 0 ? 1 : 0);
  return options;
}

TEST(Golden, TwoSidedPshellBytes) {
  const auto [points, normals] = golden_points();
  expect_golden_bytes(
      "v2_1.pshell",
      pshell_bytes(TestShell(points, normals, two_sided_golden_options()).content()));
}

TEST(Golden, TwoSidedPshellValues) {
  const auto shell = Pshell::open(golden_path("v2_1.pshell"), Verify::kStructureAndChecksums);
  ASSERT_TRUE(shell) << to_line(shell.error());
  EXPECT_EQ(shell->header().file.minor, 1u);
  ASSERT_NE(shell->view().two_sided, nullptr);
  for (std::size_t i = 0; i < 128; ++i) {
    EXPECT_EQ(shell->view().two_sided[i], std::min<std::size_t>(i, 99) % 3 == 0) << i;
  }
  const auto old = Pshell::open(golden_path("v2.pshell"));
  ASSERT_TRUE(old);
  EXPECT_EQ(old->header().file.minor, 0u);
  EXPECT_EQ(old->view().two_sided, nullptr);
}

TEST(Golden, VoxmapValues) {
  const auto map = Voxmap::open(golden_path("v2.vox"), Verify::kStructureAndChecksums);
  ASSERT_TRUE(map) << to_line(map.error());
  const DenseVoxels voxels = golden_voxels();
  std::int64_t wrong = 0, non_free = 0;
  for_each_voxel({{-530, -10, -10}, {-430, 66, 66}}, [&](const VoxelIndex& v) {
    const VoxelValue value = map->value(v[0], v[1], v[2]);
    wrong += value != voxels.value(v[0], v[1], v[2]);
    non_free += value != VoxelValue::kFree;
  });
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(non_free, 20 * 20 * 20 + 5 * 5 * 5);
}

TEST(Golden, VoxmapFacts) {
  const auto map = Voxmap::open(golden_path("v2.vox"));
  ASSERT_TRUE(map) << to_line(map.error());
  const VoxmapHeader& h = map->header();
  EXPECT_EQ(h.voxel_size_m, 0.0025);
  EXPECT_EQ(h.origin_voxel, (VoxelIndex{-514, 6, 6}));
  EXPECT_EQ(h.dims_voxels, (std::array<std::uint64_t, 3>{47, 37, 37}));
  EXPECT_EQ(h.valid_min_voxel, (VoxelIndex{-600, -100, -100}));
  EXPECT_EQ(h.valid_max_voxel, (VoxelIndex{-400, 200, 200}));
  EXPECT_EQ(h.cropped_sides, kCroppedMaxX);
  EXPECT_EQ(h.offset_layers, 1u);
  EXPECT_EQ(h.metric, static_cast<std::uint32_t>(Metric::kChebyshev));
  EXPECT_EQ(h.directory_origin, (VoxelIndex{-1024, 0, 0}));
  EXPECT_EQ(h.directory_dims, (std::array<std::uint32_t, 3>{2, 1, 1}));
  EXPECT_EQ(h.interior_voxels, 16u * 16 * 16 + 1);
  EXPECT_EQ(h.surface_voxels, 18u * 18 * 18 - 16 * 16 * 16 + 26);
  EXPECT_EQ(h.proximity_voxels, 20u * 20 * 20 - 18 * 18 * 18 + 98);
  EXPECT_EQ(h.static_deviation_m, 0x1p-17 * 1.024);
  EXPECT_EQ(map->distances(), nullptr);
  EXPECT_EQ(map->objects(), nullptr);
  EXPECT_EQ(map->provenance(), R"({"made by":"tests/support/golden_content.h","inputs":[]})");
}

// Clearances of three free boxes, worked out by hand.
TEST(Golden, VoxmapClearances) {
  const auto map = Voxmap::open(golden_path("v2.vox"));
  ASSERT_TRUE(map) << to_line(map.error());
  const VoxmapView& view = map->view();
  const auto at = [&](int i, int j, int k) { return view.lookup(i + 1024, j, k); };
  const VoxelLookup block = at(-1024, 100, 100);  // 64^3 at (-1024, 64, 64)
  EXPECT_EQ(block.edge_voxels, 64u);
  EXPECT_EQ(block.clearance, 447u);         // its last x is -961, the proximity layer's x -514
  const VoxelLookup cell = at(-528, 8, 8);  // 8^3 with last x = -521
  EXPECT_EQ(cell.edge_voxels, 8u);
  EXPECT_EQ(cell.clearance, 7u);
  const VoxelLookup cropped = at(-390, 8, 8);  // beyond the cropped side x = -400: unknown
  EXPECT_EQ(cropped.code, 0u);
  EXPECT_EQ(cropped.clearance, 0u);
}

TEST(Golden, DistancesAndObjects) {
  const auto map = Voxmap::open(golden_path("v2_distances.vox"), Verify::kStructureAndChecksums);
  ASSERT_TRUE(map) << to_line(map.error());
  ASSERT_NE(map->distances(), nullptr);
  ASSERT_NE(map->objects(), nullptr);
  for_each_voxel({{0, 0, 0}, {8, 8, 8}}, [&](const VoxelIndex& v) {
    const auto [x, y, z] = v;
    const std::uint32_t code = GoldenDistances::code(x, y, z);
    EXPECT_EQ(map->value(x, y, z), GoldenDistances::value(x, y, z));
    EXPECT_EQ(map->distances()
                  ->lookup(static_cast<int>(x), static_cast<int>(y), static_cast<int>(z))
                  .code,
              code);
    EXPECT_EQ(map->min_distance_m(x, y, z), (code - 127.0) * (0.001 / 32));
    EXPECT_EQ(map->nearest_object(x, y, z), GoldenDistances::object(x, y, z));
  });
  // A few of them by hand.
  EXPECT_EQ(map->value(3, 3, 3), VoxelValue::kInterior);
  EXPECT_EQ(map->value(1, 3, 3), VoxelValue::kSurface);
  EXPECT_EQ(map->value(0, 3, 3), VoxelValue::kProximity);
  EXPECT_EQ(map->value(7, 0, 0), VoxelValue::kFree);
  EXPECT_EQ(map->distances()->lookup(3, 3, 3).code, 127u);
  EXPECT_EQ(map->distances()->lookup(1, 3, 3).code, 127u + 64);
  EXPECT_EQ(map->distances()->lookup(2, 2, 3).code, 127u + 45);  // 32 sqrt(2) = 45.25
  EXPECT_EQ(map->nearest_object(0, 0, 0), 1u);
  EXPECT_EQ(map->nearest_object(7, 7, 7), 2u);
  EXPECT_EQ(map->object_name(1), "left");
  EXPECT_EQ(map->object_name(2), "right");
  EXPECT_EQ(map->object_name(0), "");
  EXPECT_EQ(map->object_name(3), "");
  // Outside the brick, and outside the directory.
  EXPECT_EQ(map->min_distance_m(8, 0, 0), 128 * (0.001 / 32));
  EXPECT_EQ(map->min_distance_m(-1, 0, 0), 128 * (0.001 / 32));
  EXPECT_EQ(map->nearest_object(8, 0, 0), 0u);
  EXPECT_EQ(map->nearest_object(-1, 0, 0), 0u);
  EXPECT_EQ(map->view().lookup(64, 0, 0).clearance, 57u);
  ASSERT_EQ(map->compliance().size(), 4u);
  EXPECT_EQ(map->compliance()[3], 1.75f);
}

std::vector<std::string> lines_of_specification() {
  std::ifstream file(test::source_path("formats/voxmap_format.md"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) lines.push_back(line);
  return lines;
}

// The dump at the end of voxmap_format.md: an offset, bytes in hexadecimal, two spaces, text.
TEST(Golden, TheDumpInTheSpecificationIsTrue) {
  const auto file = FileBytes::read(golden_path("v2_distances.vox"));
  ASSERT_TRUE(file);
  const std::vector<std::string> lines = lines_of_specification();
  auto line = std::find(lines.begin(), lines.end(), "## 15. A file, byte by byte");
  line = std::find(line, lines.end(), "```");
  ASSERT_NE(line, lines.end());
  int rows = 0;
  for (++line; line != lines.end() && *line != "```"; ++line, ++rows) {
    SCOPED_TRACE(*line);
    std::size_t at = std::stoul(line->substr(0, 5));
    std::istringstream bytes(line->substr(7, 47));
    for (unsigned byte = 0; bytes >> std::hex >> byte; ++at) {
      ASSERT_LT(at, file->bytes().size());
      EXPECT_EQ(static_cast<unsigned>(file->bytes()[at]), byte) << "byte " << at;
    }
    EXPECT_TRUE(bytes.eof());
  }
  EXPECT_EQ(rows, 37);
}

TEST(Golden, ChecksumsHaveTheKnownAnswers) {
  EXPECT_EQ(checksum(std::as_bytes(std::span("Forcelayer", 10))), 0x41bf75e4abdea3e4u);
  EXPECT_EQ(checksum({}), 0x2d06800538d394c2u);
  std::array<unsigned char, 2000> bytes;
  for (std::size_t n = 0; n < bytes.size(); ++n) bytes[n] = static_cast<unsigned char>(n % 251);
  EXPECT_EQ(checksum(std::as_bytes(std::span(bytes))), 0x8d38fc31dc9d9fabu);
  int told = 0;
  for (const std::string& line : lines_of_specification()) {
    told += line.find("0x41bf75e4abdea3e4") != std::string::npos;
    told += line.find("0x2d06800538d394c2") != std::string::npos;
    told += line.find("0x8d38fc31dc9d9fab") != std::string::npos;
  }
  EXPECT_EQ(told, 3);
}

TEST(Golden, PshellValues) {
  const auto shell = Pshell::open(golden_path("v2.pshell"), Verify::kStructureAndChecksums);
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
  EXPECT_EQ(h.convex_radius_m, 0.00175);
  EXPECT_EQ(h.convex_gap_m, 0.00025);
  const SurfaceDistanceTerms terms = shell->surface_distance_terms();
  ASSERT_EQ(terms.losses.size(), 3u);
  EXPECT_EQ(terms.losses[1].distance_m, 0.004);
  EXPECT_EQ(terms.losses[1].loss_m, 0.00075);
  EXPECT_EQ(h.part_deviation_m, 0.000001);
  EXPECT_EQ(h.center_m, (std::array<double, 3>{0.5, 0, 0}));
  EXPECT_EQ(h.method, static_cast<std::uint32_t>(ShellMethod::kSurface));
}

}  // namespace
}  // namespace forcelayer::testing

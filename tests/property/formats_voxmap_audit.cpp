// The audit accepts the truth and notices every single untruth.
#include <gtest/gtest.h>

#include <random>

#include "formats/voxmap_audit.h"
#include "tests/support/file_surgery.h"
#include "tests/support/golden_content.h"

namespace forcelayer::testing {
namespace {

DenseVoxels random_scene(std::mt19937_64& random) {
  const VoxelIndex lowest{static_cast<std::int64_t>(random() % 1100) - 600, -20, 500};
  DenseVoxels voxels(lowest, {40, 40, 40}, 0.001);
  for (int box = 0; box < 4; ++box) {
    VoxelIndex low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = lowest[axis] + static_cast<std::int64_t>(random() % 40);
      high[axis] =
          std::min(lowest[axis] + 40, low[axis] + 1 + static_cast<std::int64_t>(random() % 20));
    }
    voxels.fill(low, high, static_cast<VoxelValue>(random() % 4));
  }
  voxels.set(lowest[0] + 20, lowest[1] + 20, lowest[2] + 20, VoxelValue::kSurface);
  return voxels;
}

DenseVoxmapOptions random_options(std::mt19937_64& random, const DenseVoxels& voxels) {
  DenseVoxmapOptions options;
  options.clearances = true;
  options.share_equal_nodes = random() % 2;
  options.collapse_uniform = random() % 2;
  options.cropped_sides = static_cast<std::uint32_t>(random() % 64);
  options.valid_box = voxels.box();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    options.valid_box.low[axis] -= static_cast<std::int64_t>(random() % 30);
    options.valid_box.high[axis] += static_cast<std::int64_t>(random() % 30);
  }
  return options;
}

Status audit(AlignedBytes& bytes) {
  resign(bytes.bytes());
  const auto map = Voxmap::from_bytes(bytes.bytes(), "scene.vox", Verify::kStructureAndChecksums);
  return map ? audit_voxmap(*map, "scene.vox") : Status(map.error());
}

TEST(VoxmapAudit, AcceptsTheTruth) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const DenseVoxels voxels = random_scene(random);
    AlignedBytes bytes = dense_voxmap_bytes(voxels, random_options(random, voxels));
    const Status status = audit(bytes);
    EXPECT_TRUE(status) << to_line(status.error());
  }
}

TEST(VoxmapAudit, AcceptsGoldenFilesAndAnEmptyScene) {
  AlignedBytes golden = golden_file_bytes("v1.vox");
  EXPECT_TRUE(audit(golden));
  AlignedBytes wide = golden_file_bytes("v1_wide.vox");
  EXPECT_TRUE(audit(wide));
  AlignedBytes empty = dense_voxmap_bytes(DenseVoxels({0, 0, 0}, {1, 1, 1}, 0.001));
  EXPECT_TRUE(audit(empty));
}

// Clearances of the test helper are the true distances: one more is a lie. Random entries of every
// level are raised, one at a time.
TEST(VoxmapAudit, NoticesEveryClearanceThatIsTooLarge) {
  for (std::uint64_t seed = 31; seed <= 36; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const DenseVoxels voxels = random_scene(random);
    DenseVoxmapOptions options = random_options(random, voxels);
    options.max_clearance = 4000;  // none ends at the cap
    options.share_equal_nodes = false;
    const AlignedBytes whole = dense_voxmap_bytes(voxels, options);
    for (const VoxmapSection section :
         {VoxmapSection::kDirectory, VoxmapSection::kUpperNodes, VoxmapSection::kLowerNodes}) {
      const auto id = static_cast<std::uint32_t>(section);
      const auto entry = read_at<SectionEntry>(whole.bytes(), table_entry_of(whole.bytes(), id));
      int raised = 0;
      for (int tries = 0; tries < 200 && raised < 25; ++tries) {
        AlignedBytes bytes(whole.bytes());
        const std::size_t at = entry.offset + 4 * (random() % (entry.bytes / 4));
        const auto word = read_at<std::uint32_t>(bytes.bytes(), at);
        if (!is_uniform(word) || uniform_value(word) != 0) continue;
        write_at(bytes.bytes(), at, uniform_entry(0, uniform_clearance(word) + 1));
        const Status status = audit(bytes);
        ASSERT_FALSE(status) << "clearance " << uniform_clearance(word) << " at byte " << at;
        EXPECT_NE(status.error().what.find("clearance"), std::string::npos);
        ++raised;
        // Less than the truth, or unknown, is no lie.
        write_at(bytes.bytes(), at, uniform_entry(0, uniform_clearance(word) / 2));
        ASSERT_TRUE(audit(bytes));
      }
      if (section != VoxmapSection::kDirectory) {
        EXPECT_GT(raised, 5);
      }
    }
  }
}

TEST(VoxmapAudit, NoticesWrongCountsAndBoxes) {
  for (const std::size_t at :
       {offsetof(VoxmapHeader, interior_voxels), offsetof(VoxmapHeader, surface_voxels),
        offsetof(VoxmapHeader, proximity_voxels), offsetof(VoxmapHeader, dims_voxels),
        offsetof(VoxmapHeader, dims_voxels) + 16, offsetof(VoxmapHeader, origin_voxel) + 8}) {
    AlignedBytes bytes = golden_file_bytes("v1.vox");
    write_at(bytes.bytes(), at, read_at<std::uint64_t>(bytes.bytes(), at) + 1);
    const Status status = audit(bytes);
    ASSERT_FALSE(status) << at;
    EXPECT_EQ(status.error().code, ErrorCode::kEntryInvalid);
    EXPECT_EQ(status.error().where.rfind("header (", 0), 0u);
  }
}

}  // namespace
}  // namespace forcelayer::testing

// Trees that no bake would make but the format allows: children shared anywhere, all bit widths.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "formats/voxmap_walk.h"
#include "tests/support/dense_voxmap.h"

namespace forcelayer::testing {
namespace {

// A valid tree at random over a few nodes and bricks, and its look-up in the words of
// voxmap_format.md 5, byte by byte.
class RandomTree {
 public:
  RandomTree(std::uint32_t bits, std::mt19937_64& random) : bits_(bits), random_(random) {
    header_.voxel_size_m = 0.001;
    header_.bits_per_voxel = bits;
    header_.directory_origin = {-1024, 512, 0};
    header_.directory_dims = {2, 1, 3};
    header_.origin_voxel = header_.directory_origin;
    header_.dims_voxels = {1024, 512, 1536};
    header_.valid_min_voxel = {-1024, 512, 0};
    header_.valid_max_voxel = {0, 1024, 1536};
    header_.interior_voxels = 1;  // the counts of such a tree do not matter here
    if (bits != 2) {
      header_.range_m = header_.quantum_m = 0.001;
      header_.surface_code = 1 + pick(max_code() - 2);
      header_.proximity_code = header_.surface_code + 1;
      header_.free_code = header_.surface_code + 2;
    }
    fill(directory_, 6, kNodes);
    fill(upper_, kNodes * kNodeEntries, kNodes);
    fill(lower_, kNodes * kNodeEntries, kBricks);
    for (std::uint32_t n = 0; n < kBricks * brick_bytes(bits) / 4; ++n) {
      bricks_.push_back(static_cast<std::uint32_t>(random()));
    }
  }

  AlignedBytes bytes() const {
    return AlignedBytes(voxmap_bytes({header_, directory_, upper_, lower_, bricks_, {}, ""}));
  }

  VoxelValue value(const VoxelIndex& world) const {
    std::array<std::uint64_t, 3> r{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t relative = world[axis] - header_.directory_origin[axis];
      if (relative < 0 || relative >= 512 * std::int64_t{header_.directory_dims[axis]}) {
        return VoxelValue::kFree;
      }
      r[axis] = static_cast<std::uint64_t>(relative);
    }
    std::uint64_t entry = directory_[(r[0] / 512 * 1 + r[1] / 512) * 3 + r[2] / 512];
    for (const auto& [nodes, edge] : {std::pair{&upper_, 64u}, std::pair{&lower_, 8u}}) {
      if (entry >> 31) return meaning(entry & 255);
      entry = (*nodes)[entry * 512 + r[0] / edge % 8 * 64 + r[1] / edge % 8 * 8 + r[2] / edge % 8];
    }
    if (entry >> 31) return meaning(entry & 255);
    const std::uint64_t bit = (r[0] % 8 * 64 + r[1] % 8 * 8 + r[2] % 8) * bits_;
    const auto* stored = reinterpret_cast<const std::uint8_t*>(bricks_.data());
    const unsigned byte = stored[entry * 64 * bits_ + bit / 8];
    return meaning(byte >> bit % 8 & max_code());
  }

 private:
  static constexpr std::uint32_t kNodes = 3, kBricks = 5;

  std::uint32_t max_code() const { return (1u << bits_) - 1; }
  std::uint32_t pick(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }

  VoxelValue meaning(std::uint64_t code) const {
    if (bits_ == 2) return static_cast<VoxelValue>(code);
    if (code < header_.surface_code) return VoxelValue::kInterior;
    if (code < header_.proximity_code) return VoxelValue::kSurface;
    return code < header_.free_code ? VoxelValue::kProximity : VoxelValue::kFree;
  }

  // Children more often than uniform values: the way down is what is tested.
  void fill(std::vector<std::uint32_t>& entries, std::uint32_t count, std::uint32_t children) {
    for (std::uint32_t n = 0; n < count; ++n) {
      if (pick(4) != 0) {
        entries.push_back(pick(children));
        continue;
      }
      const std::uint32_t code = pick(max_code() + 1);
      const bool free = meaning(code) == VoxelValue::kFree;
      entries.push_back(uniform_entry(code, free ? pick(kMaxClearance + 1) : 0));
    }
  }

  std::uint32_t bits_;
  std::mt19937_64& random_;
  VoxmapHeader header_{};
  std::vector<std::uint32_t> directory_, upper_, lower_, bricks_;
};

TEST(VoxmapTree, LookUpFollowsTheSpecificationAtEveryWidth) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    for (const std::uint32_t bits : {2u, 4u, 8u}) {
      SCOPED_TRACE("seed " + std::to_string(seed) + " bits " + std::to_string(bits));
      std::mt19937_64 random(seed);
      const RandomTree tree(bits, random);
      const AlignedBytes bytes = tree.bytes();
      const auto map =
          Voxmap::from_bytes(bytes.bytes(), "random tree", Verify::kStructureAndChecksums);
      ASSERT_TRUE(map) << to_line(map.error());
      for (int probe = 0; probe < 2000; ++probe) {
        const VoxelIndex v{-1034 + static_cast<std::int64_t>(random() % 1044),
                           502 + static_cast<std::int64_t>(random() % 532),
                           -10 + static_cast<std::int64_t>(random() % 1556)};
        ASSERT_EQ(map->value(v[0], v[1], v[2]), tree.value(v))
            << v[0] << " " << v[1] << " " << v[2];
      }
    }
  }
}

// The walk visits every voxel of the directory once, with the value that a look-up gives.
TEST(VoxmapTree, WalkCoversTheDirectoryAndAgreesWithLookUp) {
  for (std::uint64_t seed = 41; seed <= 43; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const RandomTree tree(4, random);
    const AlignedBytes bytes = tree.bytes();
    const auto map = Voxmap::from_bytes(bytes.bytes(), "random tree");
    ASSERT_TRUE(map) << to_line(map.error());
    std::uint64_t voxels = 0, wrong = 0;
    for_each_region(map->view(), [&](const VoxmapRegion& region) {
      voxels += std::uint64_t{region.edge_voxels} * region.edge_voxels * region.edge_voxels;
      const std::uint32_t n = static_cast<std::uint32_t>(voxels % 512);  // some voxel of it
      const auto at = voxmap_walk::child_low(region.low, n, region.edge_voxels / 8);
      const std::uint32_t code =
          region.is_brick ? brick_code(map->view(), region.entry, n) : uniform_value(region.entry);
      wrong += voxel_value(map->header(), code) != map->value(at[0], at[1], at[2]);
    });
    EXPECT_EQ(voxels, std::uint64_t{1024} * 512 * 1536);
    EXPECT_EQ(wrong, 0u);
  }
}

}  // namespace
}  // namespace forcelayer::testing

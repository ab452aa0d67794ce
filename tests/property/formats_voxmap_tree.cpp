// Trees that no bake would make but the format allows: children shared anywhere, in all three
// trees.
#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <vector>

#include "formats/voxinfo/occupied_boxes.h"
#include "formats/voxmap_walk.h"
#include "tests/support/dense_voxmap.h"

namespace forcelayer::testing {
namespace {

constexpr VoxelIndex kDirectoryOrigin{-1024, 512, 0};
constexpr std::array<std::uint32_t, 3> kDirectoryDims{2, 1, 3};

// A valid tree at random over a few nodes and bricks, and its look-up in the words of
// voxmap_format.md, byte by byte.
class RandomTree {
 public:
  RandomTree(std::uint32_t bits, std::uint32_t elements, std::uint32_t outside,
             std::mt19937_64& random)
      : bits_(bits), elements_(elements), outside_(outside), random_(random) {
    fill(directory_, 6, kNodes);
    fill(upper_, kNodes * kNodeEntries, kNodes);
    fill(lower_, kNodes * kNodeEntries, kBricks);
    bricks_.resize(kBricks * brick_bytes(bits) / 4);
    for (std::uint32_t n = 0; n < kBricks * kNodeEntries; ++n) {
      bricks_[n * bits / 32] |= pick(elements) << (n * bits % 32);
    }
  }

  TreeContent content() const { return {directory_, upper_, lower_, bricks_}; }

  std::uint32_t element(const VoxelIndex& world) const {
    std::array<std::uint64_t, 3> r{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::int64_t relative = world[axis] - kDirectoryOrigin[axis];
      if (relative < 0 || relative >= 512 * std::int64_t{kDirectoryDims[axis]}) return outside_;
      r[axis] = static_cast<std::uint64_t>(relative);
    }
    const std::uint32_t bits_of_a_value = bits_ == 2 ? 0xff : 0xffff;
    std::uint64_t entry = directory_[(r[0] / 512 * 1 + r[1] / 512) * 3 + r[2] / 512];
    for (const auto& [nodes, edge] : {std::pair{&upper_, 64u}, std::pair{&lower_, 8u}}) {
      if (entry >> 31) return entry & bits_of_a_value;
      entry = (*nodes)[entry * 512 + r[0] / edge % 8 * 64 + r[1] / edge % 8 * 8 + r[2] / edge % 8];
    }
    if (entry >> 31) return entry & bits_of_a_value;
    const std::uint64_t bit = (r[0] % 8 * 64 + r[1] % 8 * 8 + r[2] % 8) * bits_;
    const auto* stored =
        reinterpret_cast<const std::uint8_t*>(bricks_.data()) + entry * 64 * bits_ + bit / 8;
    if (bits_ == 16) return stored[0] + 256u * stored[1];
    return stored[0] >> bit % 8 & ((1u << bits_) - 1);
  }

 private:
  static constexpr std::uint32_t kNodes = 3, kBricks = 5;

  std::uint32_t pick(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }

  // Children more often than uniform values: the way down is what is tested.
  void fill(std::vector<std::uint32_t>& entries, std::uint32_t count, std::uint32_t children) {
    for (std::uint32_t n = 0; n < count; ++n) {
      if (pick(4) != 0) {
        entries.push_back(pick(children));
        continue;
      }
      const std::uint32_t value = pick(elements_);
      const bool free = bits_ == 2 && value == 0;
      entries.push_back(uniform_entry(value, free ? pick(kMaxClearance + 1) : 0));
    }
  }

  std::uint32_t bits_, elements_, outside_;
  std::mt19937_64& random_;
  std::vector<std::uint32_t> directory_, upper_, lower_, bricks_;
};

// Three such trees in one file.
struct RandomMap {
  static constexpr std::uint32_t kObjects = 700;

  explicit RandomMap(std::mt19937_64& random)
      : values(2, 4, 0, random), distances(8, 256, 255, random), objects(16, 701, 0, random) {}

  AlignedBytes bytes() const {
    VoxmapContent content;
    VoxmapHeader& h = content.header;
    h.voxel_size_m = 0.001;
    h.offset_layers = 1;
    h.metric = static_cast<std::uint32_t>(Metric::kEuclidean);
    h.zero_force_m = 0.002;
    h.force_depth_m = 0.001;
    h.distance_quantum_m = 0.00001;
    h.distance_zero_code = 100;
    h.object_count = kObjects;
    h.directory_origin = kDirectoryOrigin;
    h.directory_dims = kDirectoryDims;
    h.origin_voxel = kDirectoryOrigin;
    h.dims_voxels = {1024, 512, 1536};
    h.valid_min_voxel = {-1024, 512, 0};
    h.valid_max_voxel = {0, 1024, 1536};
    h.interior_voxels = 1;  // the counts of such a tree do not matter here
    content.values = values.content();
    content.distances = distances.content();
    content.objects = objects.content();
    const std::string names(kObjects, '\0');
    content.object_names = names;
    return AlignedBytes(voxmap_bytes(content));
  }

  RandomTree values, distances, objects;
};

TEST(VoxmapTree, LookUpFollowsTheSpecificationInEveryTree) {
  for (std::uint64_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const RandomMap tree(random);
    const AlignedBytes bytes = tree.bytes();
    const auto map =
        Voxmap::from_bytes(bytes.bytes(), "random tree", Verify::kStructureAndChecksums);
    ASSERT_TRUE(map) << to_line(map.error());
    for (int probe = 0; probe < 4000; ++probe) {
      const VoxelIndex v{-1034 + static_cast<std::int64_t>(random() % 1044),
                         502 + static_cast<std::int64_t>(random() % 532),
                         -10 + static_cast<std::int64_t>(random() % 1556)};
      SCOPED_TRACE(std::to_string(v[0]) + " " + std::to_string(v[1]) + " " + std::to_string(v[2]));
      ASSERT_EQ(static_cast<std::uint32_t>(map->value(v[0], v[1], v[2])), tree.values.element(v));
      ASSERT_EQ(map->nearest_object(v[0], v[1], v[2]), tree.objects.element(v));
      const std::uint32_t code = tree.distances.element(v);
      ASSERT_EQ(map->min_distance_m(v[0], v[1], v[2]),
                code == 0 ? -std::numeric_limits<double>::infinity() : (code - 100.0) * 0.00001);
    }
  }
}

// Calls visit for every region, with some voxel of it.
template <std::uint32_t kBits>
void expect_walk_agrees(const TreeView<kBits>& view, const RandomTree& tree) {
  std::uint64_t voxels = 0, wrong = 0;
  for_each_region(view, [&](const VoxmapRegion& region) {
    voxels += std::uint64_t{region.edge_voxels} * region.edge_voxels * region.edge_voxels;
    const std::uint32_t n = static_cast<std::uint32_t>(voxels % 512);
    const auto at = voxmap_walk::child_low(region.low, n, region.edge_voxels / 8);
    const std::uint32_t element = region.is_brick ? view.brick_code(region.entry, n)
                                                  : TreeView<kBits>::uniform(region.entry, 1).code;
    wrong += element != tree.element(at);
  });
  EXPECT_EQ(voxels, std::uint64_t{1024} * 512 * 1536);
  EXPECT_EQ(wrong, 0u);
}

// The walk visits every voxel of the directory once, with the element that a look-up gives.
TEST(VoxmapTree, WalkCoversTheDirectoryAndAgreesWithLookUp) {
  std::mt19937_64 random(41);
  const RandomMap tree(random);
  const AlignedBytes bytes = tree.bytes();
  const auto map = Voxmap::from_bytes(bytes.bytes(), "random tree");
  ASSERT_TRUE(map) << to_line(map.error());
  expect_walk_agrees(map->view(), tree.values);
  expect_walk_agrees(*map->distances(), tree.distances);
  expect_walk_agrees(*map->objects(), tree.objects);
}

// A walk over what is not free finds every such voxel, as one over all does.
TEST(VoxmapTree, OccupiedBoxesHaveAllThatIsNotBackground) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    std::mt19937_64 random(seed);
    const RandomMap tree(random);
    const AlignedBytes bytes = tree.bytes();
    const auto map = Voxmap::from_bytes(bytes.bytes(), "random tree");
    ASSERT_TRUE(map) << to_line(map.error());
    const auto occupied = occupied_boxes(*map);
    for_each_region(map->view(), [&](const VoxmapRegion& region) {
      const bool is_free = !region.is_brick && uniform_value(region.entry) == 0;
      if (is_free && region.edge_voxels == kBrickEdge) return;  // not worth a look
      ASSERT_EQ(occupied(region.low, region.edge_voxels), !is_free);
    });
  }
}

// How much a walk looks at is known before it begins: counted here one region at a time.
TEST(VoxmapTree, StepsOfAWalkAreKnownBeforeItBegins) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937_64 random(seed);
    const RandomMap tree(random);
    const AlignedBytes bytes = tree.bytes();
    const auto map = Voxmap::from_bytes(bytes.bytes(), "random tree");
    ASSERT_TRUE(map) << to_line(map.error());
    const auto in_uniform = [](std::uint32_t value, std::uint32_t edge) { return value * edge; };
    const auto count = [&](auto wanted) {
      double steps = 2 * 1 * 3;  // cells
      std::set<std::pair<std::array<std::int64_t, 3>, std::int64_t>> nodes;
      for_each_region_where(map->view(), wanted, [&](const VoxmapRegion& region) {
        steps += region.is_brick ? kNodeEntries
                                 : in_uniform(TreeView<kValueBits>::uniform(region.entry, 1).code,
                                              region.edge_voxels);
        for (std::int64_t edge : {64, 512}) {  // of the nodes around it
          if (region.edge_voxels >= edge) continue;
          std::array<std::int64_t, 3> low = region.low;
          for (std::int64_t& at : low) at &= -edge;
          nodes.insert({low, edge});
        }
      });
      return steps + kNodeEntries * static_cast<double>(nodes.size());
    };
    const TreeCounts counts{map->upper_node_count(), map->lower_node_count(), 0, 0};
    const auto every = [](const auto&...) { return true; };
    EXPECT_EQ(walk_steps(map->view(), counts, every, in_uniform), count(every));
    const auto occupied = occupied_boxes(*map);
    EXPECT_EQ(occupied.steps(in_uniform), count(occupied));
  }
}

TEST(VoxmapTree, AWalkOfTooManyStepsIsRefused) {
  EXPECT_TRUE(check_walk(kMaxWalkSteps, "a.vox"));
  const Status refused = check_walk(std::nextafter(kMaxWalkSteps, 1e300), "a.vox");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().file, "a.vox");
  EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
}

// A file of 0.8 MB that describes 200,000 cells of stored nodes and bricks, all of them free but
// one: visiting all would take hours.
TEST(VoxmapTree, OccupiedBoxesLeaveOutNodesThatAreAllFree) {
  constexpr std::uint32_t kCells = 60;
  std::vector<std::uint32_t> directory(kCells * kCells * kCells, 1), upper(2 * kNodeEntries, 1),
      lower(2 * kNodeEntries, 1), bricks(2 * 16 * kValueBits, 0);
  directory[directory.size() / 2] = 0;  // cell 0 of nodes and bricks holds a voxel
  upper[70] = 0;
  lower[300] = 0;
  bricks[5] = 1;
  VoxmapContent content;
  VoxmapHeader& h = content.header;
  h.voxel_size_m = 0.001;
  h.offset_layers = 1;
  h.directory_dims = {kCells, kCells, kCells};
  h.dims_voxels = {1, 1, 1};
  for (std::int64_t& high : h.valid_max_voxel) high = 512 * kCells;
  h.interior_voxels = 1;
  content.values = {directory, upper, lower, bricks};
  const AlignedBytes bytes(voxmap_bytes(content));
  const auto map = Voxmap::from_bytes(bytes.bytes(), "free");
  ASSERT_TRUE(map) << to_line(map.error());
  std::uint64_t regions = 0, voxels = 0;
  for_each_region_where(map->view(), occupied_boxes(*map), [&](const VoxmapRegion& region) {
    ++regions;
    ASSERT_TRUE(region.is_brick);
    for (std::uint32_t n = 0; n < kNodeEntries; ++n) {
      voxels += map->view().brick_code(region.entry, n) != 0;
    }
  });
  EXPECT_EQ(regions, kNodeEntries);
  EXPECT_EQ(voxels, 1u);
}

}  // namespace
}  // namespace forcelayer::testing

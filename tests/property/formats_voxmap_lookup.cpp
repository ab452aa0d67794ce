// Look-ups in the tree against the dense array that it was built from.
#include <gtest/gtest.h>

#include <random>

#include "tests/support/dense_voxmap.h"

namespace forcelayer::testing {
namespace {

struct Case {
  VoxelIndex lowest;
  std::array<std::int64_t, 3> extent;
};

// Boxes of one value, some aligned with the tree, and scattered voxels.
DenseVoxels random_voxels(const Case& shape, std::mt19937_64& random) {
  DenseVoxels voxels(shape.lowest, shape.extent, 0.005);
  const VoxelBox& all = voxels.box();
  const auto below = [&](std::int64_t n) {
    return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(n));
  };
  for (int box = 0; box < 12; ++box) {
    const std::int64_t grain = std::int64_t{1} << below(5);  // 1 to 16 voxels
    VoxelIndex low{}, high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = all.low[axis] + below(shape.extent[axis]) / grain * grain;
      high[axis] = std::min(all.high[axis], low[axis] + grain * (1 + below(4)));
    }
    voxels.fill(low, high, static_cast<VoxelValue>(below(4)));
  }
  for (int dot = 0; dot < 200; ++dot) {
    voxels.set(all.low[0] + below(shape.extent[0]), all.low[1] + below(shape.extent[1]),
               all.low[2] + below(shape.extent[2]), static_cast<VoxelValue>(below(4)));
  }
  return voxels;
}

VoxelBox grown(VoxelBox box, std::int64_t margin) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] -= margin;
    box.high[axis] += margin;
  }
  return box;
}

void expect_equal_everywhere(const DenseVoxels& voxels, const Voxmap& map) {
  std::int64_t wrong = 0;
  for_each_voxel(grown(voxels.box(), 3), [&](const VoxelIndex& v) {
    wrong += map.value(v[0], v[1], v[2]) != voxels.value(v[0], v[1], v[2]);
  });
  EXPECT_EQ(wrong, 0);
}

TEST(VoxmapLookup, EqualsDenseArray) {
  const Case shapes[] = {{{0, 0, 0}, {40, 24, 17}},
                         {{-20, -520, 505}, {40, 30, 20}},
                         {{-1030, 1000, -5}, {20, 60, 10}},
                         {{kMaxVoxelIndex - 1024, -kMaxVoxelIndex, 0}, {16, 16, 16}}};
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    std::mt19937_64 random(seed);
    const DenseVoxels voxels = random_voxels(shapes[seed % std::size(shapes)], random);
    for (const bool fraction : {true, false}) {
      for (const bool collapse : {true, false}) {
        SCOPED_TRACE("seed " + std::to_string(seed) + " share " + std::to_string(fraction) +
                     " collapse " + std::to_string(collapse));
        const BuiltVoxmap built(voxels,
                                {.share_equal_nodes = fraction, .collapse_uniform = collapse});
        expect_equal_everywhere(voxels, built.voxmap());
        if (HasFatalFailure()) return;
      }
    }
  }
}

// Every clearance that a look-up returns is the true distance, or the cap.
TEST(VoxmapLookup, ClearanceIsTheDistanceToTheNearestNonFreeVoxel) {
  constexpr std::int64_t kCap = 40;
  for (std::uint64_t seed = 21; seed <= 23; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const DenseVoxels voxels = random_voxels({{500, -30, 10}, {30, 30, 30}}, random);
    const BuiltVoxmap built(voxels, {.clearances = true, .max_clearance = kCap});
    const VoxmapView& view = built.voxmap().view();
    int probed = 0;
    for_each_voxel({{0, 0, 0}, {9, 9, 9}}, [&](const VoxelIndex& probe) {
      std::array<std::int32_t, 3> r{};
      VoxelBox entry;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t world = voxels.box().low[axis] - 24 + 8 * probe[axis];
        r[axis] = static_cast<std::int32_t>(world - view.directory_origin[axis]);
      }
      if (!view.contains(r[0], r[1], r[2])) return;
      const VoxelLookup found = view.lookup(r[0], r[1], r[2]);
      if (found.edge_voxels == 1 || found.code != 0) return;
      const auto edge = static_cast<std::int32_t>(found.edge_voxels);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        entry.low[axis] = view.directory_origin[axis] + r[axis] / edge * edge;
        entry.high[axis] = entry.low[axis] + edge;
      }
      std::int64_t nearest = kCap;
      for_each_voxel(voxels.box(), [&](const VoxelIndex& v) {
        if (voxels.value(v[0], v[1], v[2]) == VoxelValue::kFree) return;
        nearest = std::min(nearest, voxel_distance(entry, v));
      });
      EXPECT_EQ(found.clearance, nearest);
      ++probed;
    });
    EXPECT_GT(probed, 50);
  }
}

TEST(VoxmapLookup, FarOutsideIsFree) {
  DenseVoxels voxels({0, 0, 0}, {8, 8, 8}, 0.005);
  voxels.fill({0, 0, 0}, {8, 8, 8}, VoxelValue::kInterior);
  const BuiltVoxmap built(voxels);
  for (const std::int64_t far : {INT64_MIN, INT64_MIN + 1, -std::int64_t{1}, std::int64_t{512},
                                 std::int64_t{1} << 40, INT64_MAX}) {
    EXPECT_EQ(built.voxmap().value(far, 0, 0), VoxelValue::kFree) << far;
    EXPECT_EQ(built.voxmap().value(0, far, 0), VoxelValue::kFree) << far;
    EXPECT_EQ(built.voxmap().value(0, 0, far), VoxelValue::kFree) << far;
  }
}

TEST(VoxmapLookup, SceneWithoutVoxelsIsFree) {
  const BuiltVoxmap built(DenseVoxels({0, 0, 0}, {1, 1, 1}, 0.005));
  EXPECT_EQ(built.voxmap().value(0, 0, 0), VoxelValue::kFree);
  EXPECT_EQ(built.voxmap().header().directory_dims[0], 0u);
}

}  // namespace
}  // namespace forcelayer::testing

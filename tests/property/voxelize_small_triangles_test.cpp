// Small triangles drawn in vectors against the scalar overlap test, for every instruction set.
#include <gtest/gtest.h>

#include <hwy/targets.h>

#include <algorithm>
#include <bit>
#include <random>

#include "formats/mesh/voxel_overlap.h"
#include "voxelize/brick_bits.h"
#include "voxelize/small_triangles.h"

namespace forcelayer {
namespace {

using Random = std::mt19937_64;
using Corners = std::array<std::array<std::int32_t, 3>, 3>;

std::int32_t uniform(Random& random, std::int32_t low, std::int32_t high) {
  return std::uniform_int_distribution<std::int32_t>(low, high)(random);
}

// A triangle in at most 8 voxels along every axis that touches the node's box.
Corners random_triangle(Random& random) {
  constexpr std::int32_t kUnit = kSnapUnits;
  const std::int32_t size = std::array{1, 2, 4, 8}[static_cast<std::size_t>(uniform(random, 0, 3))];
  const std::int32_t grid =
      std::array{1, 1, 256, 1024}[static_cast<std::size_t>(uniform(random, 0, 3))];
  Corners corners;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::int32_t low = uniform(random, 1 - size, 63) * kUnit;
    const bool flat = uniform(random, 0, 7) == 0;
    const std::int32_t plane = low + uniform(random, 0, size * kUnit - 1) / grid * grid;
    for (auto& corner : corners) {
      corner[d] = flat ? plane : low + uniform(random, 0, size * kUnit - 1) / grid * grid;
    }
  }
  const std::int32_t degenerate = uniform(random, 0, 15);
  if (degenerate == 0) corners[2] = corners[static_cast<std::size_t>(uniform(random, 0, 1))];
  if (degenerate == 1) corners[1] = corners[2] = corners[0];
  if (degenerate == 2) {  // collinear
    for (std::size_t d = 0; d < 3; ++d) {
      corners[1][d] += (corners[0][d] + corners[1][d]) & 1;
      corners[2][d] = (corners[0][d] + corners[1][d]) / 2;
    }
  }
  return corners;
}

bool is_small(const Corners& corners) {
  for (std::size_t d = 0; d < 3; ++d) {
    const auto [low, high] = std::minmax({corners[0][d], corners[1][d], corners[2][d]});
    if ((high >> kSnapBits) - (low >> kSnapBits) >= SmallTriangles::kMaxVoxels) return false;
  }
  return true;
}

void draw_slowly(const Corners& corners, NodeCanvas& canvas) {
  LatticeTriangle triangle;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t d = 0; d < 3; ++d) triangle[k][d] = corners[k][d];
  }
  for (const VoxelIndex& voxel : overlapped_voxels(triangle)) {
    if (std::any_of(voxel.begin(), voxel.end(), [](std::int64_t x) { return x < 0 || x > 63; }))
      continue;
    const auto x = static_cast<unsigned>(voxel[0]), y = static_cast<unsigned>(voxel[1]),
               z = static_cast<unsigned>(voxel[2]);
    set(canvas.brick(x >> 3, y >> 3, z >> 3), (x & 7) << 6 | (y & 7) << 3 | (z & 7));
  }
}

void expect_equal_drawings(std::uint64_t seed) {
  SCOPED_TRACE(::testing::Message() << "seed " << seed);
  Random random(seed);
  static NodeCanvas fast, slow;
  fast.clear();
  slow.clear();
  SmallTriangles triangles;
  for (std::int32_t n = uniform(random, 1, 40); n > 0; --n) {
    const Corners corners = random_triangle(random);
    if (!is_small(corners)) continue;
    triangles.add(corners);
    if (triangles.full()) triangles.draw(fast);
    draw_slowly(corners, slow);
  }
  triangles.draw(fast);
  ASSERT_EQ(fast.touched, slow.touched);
  for_each_set(slow.touched, [&](unsigned n) { ASSERT_EQ(fast.bricks[n], slow.bricks[n]); });
}

TEST(SmallTriangles, EqualTheOverlapTestOnEveryInstructionSet) {
  for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
      expect_equal_drawings(seed);
      if (HasFatalFailure()) break;
    }
  }
  hwy::SetSupportedTargetsForTest(0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace
}  // namespace forcelayer

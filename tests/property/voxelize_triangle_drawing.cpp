// Triangles drawn in vector lanes against the scalar overlap test, for every instruction set.
#include <gtest/gtest.h>

#include <hwy/targets.h>

#include <algorithm>
#include <random>

#include "formats/lattice/brick_bits.h"
#include "formats/lattice/voxel_overlap.h"
#include "tests/support/soups.h"
#include "voxelize/scan/large_triangle.h"
#include "voxelize/scan/small_triangles.h"

namespace forcelayer {
namespace {

using reference::Random;
using reference::whole;

// A triangle with corners in a box of `size` voxels that touches the node's.
lattice::LatticeTriangle random_triangle(Random& random, std::int64_t size) {
  const std::int64_t grid =
      std::array{1, 1, 256, 1024}[static_cast<std::size_t>(whole(random, 0, 3))];
  lattice::LatticeTriangle corners;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::int64_t low = whole(random, 1 - size, 63) * lattice::kSnapUnits;
    const bool flat = whole(random, 0, 7) == 0;
    const std::int64_t plane = low + whole(random, 0, size * lattice::kSnapUnits - 1) / grid * grid;
    for (auto& corner : corners) {
      corner[d] =
          flat ? plane : low + whole(random, 0, size * lattice::kSnapUnits - 1) / grid * grid;
    }
  }
  const std::int64_t degenerate = whole(random, 0, 15);
  if (degenerate == 0) corners[2] = corners[static_cast<std::size_t>(whole(random, 0, 1))];
  if (degenerate == 1) corners[1] = corners[2] = corners[0];
  if (degenerate == 2) {  // collinear
    for (std::size_t d = 0; d < 3; ++d) {
      corners[1][d] -= (corners[0][d] + corners[1][d]) & 1;
      corners[2][d] = (corners[0][d] + corners[1][d]) / 2;
    }
  }
  return corners;
}

bool is_small(const lattice::LatticeTriangle& corners) {
  for (std::size_t d = 0; d < 3; ++d) {
    const auto [low, high] = std::minmax({corners[0][d], corners[1][d], corners[2][d]});
    if ((high >> lattice::kSnapBits) - (low >> lattice::kSnapBits) >=
        scan::SmallTriangles::kMaxVoxels)
      return false;
  }
  return true;
}

// Draws the voxels of the node that the triangle meets, cell by cell.
void draw_slowly(const lattice::LatticeTriangle& corners, scan::NodeCanvas& canvas) {
  const lattice::TriangleOverlap triangle(corners);
  lattice::for_each_cell(triangle.cells({0, 0, 0}, 3), [&](unsigned x, unsigned y, unsigned z) {
    const lattice::BrickMask voxels = triangle.cells({8 * x, 8 * y, 8 * z});
    if (voxels.any()) canvas.brick(x, y, z) = canvas.brick(x, y, z) | voxels;
  });
}

void expect_equal_canvases(const scan::NodeCanvas& fast, const scan::NodeCanvas& slow) {
  ASSERT_EQ(fast.touched, slow.touched);
  lattice::for_each_set(slow.touched,
                        [&](unsigned n) { ASSERT_EQ(fast.bricks[n], slow.bricks[n]); });
}

// Some triangles of up to 8 voxels.
void expect_equal_small(std::uint64_t seed) {
  Random random(seed);
  static scan::NodeCanvas fast, slow;
  fast.clear();
  slow.clear();
  scan::SmallTriangles triangles;
  for (std::int64_t n = whole(random, 1, 40); n > 0; --n) {
    const lattice::LatticeTriangle corners =
        random_triangle(random, std::int64_t{1} << whole(random, 0, 3));
    if (!is_small(corners)) continue;
    std::array<int, 3> low, high;
    for (std::size_t d = 0; d < 3; ++d) {
      const auto [smallest, largest] = std::minmax({corners[0][d], corners[1][d], corners[2][d]});
      low[d] = static_cast<int>(smallest >> lattice::kSnapBits);
      high[d] = static_cast<int>(largest >> lattice::kSnapBits);
    }
    triangles.draw(corners, low, high, fast);
    draw_slowly(corners, slow);
  }
  triangles.finish(fast);
  expect_equal_canvases(fast, slow);
}

// One triangle of up to 512 voxels.
void expect_equal_large(std::uint64_t seed) {
  Random random(seed);
  static scan::NodeCanvas fast, slow;
  fast.clear();
  slow.clear();
  const lattice::LatticeTriangle corners =
      random_triangle(random, std::int64_t{1} << whole(random, 0, 9));
  scan::draw_large_triangle(corners, fast);
  draw_slowly(corners, slow);
  expect_equal_canvases(fast, slow);
}

// Runs `f` once for every instruction set of this machine.
template <class F>
void for_each_instruction_set(F&& f) {
  for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(target);
    f();
    hwy::SetSupportedTargetsForTest(0);
    if (::testing::Test::HasFatalFailure()) break;
  }
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

void for_each_seed(std::uint64_t count, void (*expect)(std::uint64_t seed)) {
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    expect(seed);
    if (::testing::Test::HasFatalFailure()) return;
  }
}

TEST(TriangleDrawing, SmallOnesEqualTheOverlapTestOnEveryInstructionSet) {
  for_each_instruction_set([] { for_each_seed(1500, expect_equal_small); });
}

TEST(TriangleDrawing, LargeOnesEqualTheOverlapTestOnEveryInstructionSet) {
  for_each_instruction_set([] { for_each_seed(3000, expect_equal_large); });
}

}  // namespace
}  // namespace forcelayer

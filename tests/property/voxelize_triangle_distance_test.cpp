// The kernels that find the nearest triangle, on every width of vectors: against distances in
// doubles, and against each triangle by itself.
#include "voxelize/triangle_distance.h"

#include <gtest/gtest.h>

#include "formats/mesh/voxel_overlap.h"
#include "tests/support/every_target.h"
#include "tests/support/reference_distance.h"
#include "tests/support/soups.h"

namespace forcelayer {
namespace {

using reference::Point;
using reference::Random;
using reference::whole;

constexpr auto kUnits = static_cast<float>(kSnapUnits);
constexpr float kEverywhere = 256 * kUnits;  // a reach

// Triangles of all sizes up to 128 voxels, and among them points and lines, in a box of a node of
// 64 voxels.
struct Triangles {
  Triangles(Random& random, const std::array<std::int64_t, 3>& low_voxel,
            std::int64_t edge_voxels) {
    const int count = static_cast<int>(whole(random, 1, 150));
    TriangleBatch batch(near);
    for (int i = 0; i < count; ++i) {
      const std::int64_t size = (kSnapUnits / 4) << whole(random, 0, 8);
      LatticeTriangle triangle;
      for (std::size_t d = 0; d < 3; ++d) {
        const std::int64_t from =
            low_voxel[d] * kSnapUnits + whole(random, 0, edge_voxels * kSnapUnits);
        for (auto& corner : triangle) corner[d] = from + whole(random, -size, size);
      }
      const auto kind = whole(random, 0, 7);
      if (kind < 2) triangle[2] = triangle[1];
      if (kind == 0) triangle[1] = triangle[2] = triangle[0];
      std::array<std::array<double, 3>, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t d = 0; d < 3; ++d) corners[k][d] = static_cast<double>(triangle[k][d]);
      }
      batch.add(corners, static_cast<std::uint32_t>(i));
      exact.push_back(triangle);
    }
    batch.flush();
    for (const NearTriangle& triangle : near) list.push_back(&triangle);
  }

  std::vector<LatticeTriangle> exact;
  std::vector<NearTriangle> near;
  std::vector<const NearTriangle*> list;
};

// The lowest voxel of a cell of the node.
std::array<std::int64_t, 3> random_cell(Random& random, std::int64_t edge) {
  std::array<std::int64_t, 3> low;
  for (std::int64_t& x : low) x = edge * whole(random, 0, 64 / edge - 1);
  return low;
}

PointCube cube_at(const std::array<std::int64_t, 3>& low_voxel, int step_voxels) {
  PointCube cube;
  cube.step = static_cast<float>(step_voxels) * kUnits;
  for (std::size_t d = 0; d < 3; ++d) {
    cube.first[d] = static_cast<float>(low_voxel[d]) * kUnits + cube.step / 2;
  }
  return cube;
}

// Point n of a cube, lattice units.
std::array<float, 3> point_of(const PointCube& cube, std::size_t n) {
  const std::size_t at[3] = {n >> 4, n >> 2 & 3, n & 3};
  std::array<float, 3> point;
  for (std::size_t d = 0; d < 3; ++d) {
    point[d] = cube.first[d] + cube.step * static_cast<float>(at[d]);
  }
  return point;
}

double exact_voxels(const LatticeTriangle& triangle, const std::array<float, 3>& point) {
  return reference::point_distance(triangle,
                                   {point[0] / kUnits, point[1] / kUnits, point[2] / kUnits});
}

class TriangleDistances : public test::EveryTarget {};
INSTANTIATE_TEST_SUITE_P(Targets, TriangleDistances,
                         ::testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return hwy::TargetName(target.param); });

TEST_P(TriangleDistances, OfCellsAreWithinTheErrorThatTheSearchAllows) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const Triangles triangles(random, {0, 0, 0}, 64);
    const PointCube cube =
        random() % 2 ? cube_at({0, 0, 0}, 16) : cube_at(random_cell(random, 16), 4);
    std::vector<CubeValues> squared(triangles.list.size());
    CubeValues least;
    squared_distances(triangles.list, cube, squared.data(), least);
    for (std::size_t n = 0; n < kCubePoints; ++n) {
      float lowest = 1e30f;
      for (std::size_t i = 0; i < squared.size(); ++i) {
        // A tenth of what the search allows: the header's 1e-4.
        EXPECT_NEAR(std::sqrt(squared[i][n]) / kUnits,
                    exact_voxels(triangles.exact[i], point_of(cube, n)), 1e-4)
            << "point " << n << ", triangle " << i;
        lowest = std::min(lowest, squared[i][n]);
      }
      EXPECT_EQ(least[n], lowest);
    }
  }
}

// With all triangles in one list and with each by itself: leaving out what is farther than the
// least, and what is out of reach, changes no bit.
TEST_P(TriangleDistances, TheNearestIsThatOfTheTrianglesOneByOne) {
  std::array<float, 2 * kEighths> everywhere;
  everywhere.fill(kEverywhere);
  for (std::uint64_t seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    // In the cell and beside it, so that many triangles are about as near.
    const std::array<std::int64_t, 3> low = random_cell(random, 8);
    const Triangles triangles(random, {low[0] - whole(random, 0, 8), low[1], low[2]}, 8);
    const PointCube cube = cube_at(low, 1);
    std::array<float, 2 * kEighths> reach;
    for (float& r : reach) r = static_cast<float>(whole(random, -1, 12)) * kUnits;
    NearestTriangles all, within, one;
    all.find(triangles.list, cube, everywhere);
    within.find(triangles.list, cube, reach);
    std::array<CubeValues, 2> least;
    std::array<std::array<std::uint32_t, kCubePoints>, 2> which{};
    for (CubeValues& values : least) values.fill(1e30f);
    for (std::uint32_t i = 0; i < triangles.list.size(); ++i) {
      one.find(NearList(triangles.list).subspan(i, 1), cube, everywhere);
      for (std::size_t k = 0; k < 2; ++k) {
        for (std::size_t n = 0; n < kCubePoints; ++n) {
          if (one.least(k)[n] < least[k][n]) least[k][n] = one.least(k)[n], which[k][n] = i;
        }
      }
    }
    for (std::size_t k = 0; k < 2; ++k) {
      for (std::size_t n = 0; n < kCubePoints; ++n) {
        ASSERT_EQ(all.least(k)[n], least[k][n]) << "cube " << k << ", point " << n;
        ASSERT_EQ(all.which(k, n), which[k][n]) << "cube " << k << ", point " << n;
        std::array<float, 3> point = point_of(cube, n);
        if (k == 1) point[2] += 4 * kUnits;
        EXPECT_NEAR(std::sqrt(least[k][n]) / kUnits,
                    exact_voxels(triangles.exact[which[k][n]], point), 1e-4);
        std::size_t in = k * kEighths;
        while ((eighth(static_cast<unsigned>(in % kEighths)) >> n & 1) == 0) ++in;
        if (std::sqrt(least[k][n]) > reach[in]) continue;
        ASSERT_EQ(within.least(k)[n], least[k][n]) << "cube " << k << ", point " << n;
        ASSERT_EQ(within.which(k, n), which[k][n]) << "cube " << k << ", point " << n;
      }
    }
  }
}

}  // namespace
}  // namespace forcelayer

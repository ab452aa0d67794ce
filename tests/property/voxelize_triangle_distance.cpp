// What finds the nearest triangle, on every width of vectors: the kernels against distances in
// doubles and against each triangle by itself, and the search from a node down to its cells.
#include "voxelize/distance/distance_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "formats/lattice/voxel_overlap.h"
#include "tests/support/every_target.h"
#include "tests/support/reference_distance.h"
#include "tests/support/soups.h"
#include "voxelize/distance/triangle_search.h"

namespace forcelayer {
namespace {

using reference::Random;
using reference::whole;

constexpr auto kUnits = static_cast<float>(lattice::kSnapUnits);
constexpr float kEverywhere = 256 * kUnits;  // a reach

using Voxel = std::array<std::int64_t, 3>;

// Corners anywhere in a box of that many units around `from`, and among them lines and points.
lattice::LatticeTriangle any_triangle(Random& random, const lattice::LatticePoint& from) {
  const std::int64_t size = (lattice::kSnapUnits / 4) << whole(random, 0, 8);
  lattice::LatticeTriangle triangle;
  for (std::size_t d = 0; d < 3; ++d) {
    for (auto& corner : triangle) corner[d] = from[d] + whole(random, -size, size);
  }
  const auto kind = whole(random, 0, 7);
  if (kind < 2) triangle[2] = triangle[1];
  if (kind == 0) triangle[1] = triangle[0];
  return triangle;
}

// Point n of a cube, lattice units.
std::array<float, 3> point_of(const distance::PointCube& cube, std::size_t n) {
  const std::size_t at[3] = {n >> 4, n >> 2 & 3, n & 3};
  std::array<float, 3> point;
  for (std::size_t d = 0; d < 3; ++d) {
    point[d] = cube.first[d] + cube.step * static_cast<float>(at[d]);
  }
  return point;
}

// Every other is a needle that points at one of a cube's points, and the others are anywhere in a
// box of the node.
struct Triangles {
  Triangles(Random& random, int count, const Voxel& low_voxel, std::int64_t edge_voxels,
            const distance::PointCube& cube) {
    distance::TriangleBatch batch(near);
    for (int i = 0; i < count; ++i) {
      const bool needle = random() % 2 == 0;
      const auto at =
          point_of(cube, static_cast<std::size_t>(whole(random, 0, distance::kCubePoints - 1)));
      lattice::LatticePoint from;
      for (std::size_t d = 0; d < 3; ++d) {
        from[d] = needle ? static_cast<std::int64_t>(at[d])
                         : low_voxel[d] * lattice::kSnapUnits +
                               whole(random, 0, edge_voxels * lattice::kSnapUnits);
      }
      exact.push_back(needle ? reference::random_needle(random, from, 96 * lattice::kSnapUnits)
                             : any_triangle(random, from));
      std::array<std::array<double, 3>, 3> corners;
      for (std::size_t k = 0; k < 3; ++k) {
        for (std::size_t d = 0; d < 3; ++d) corners[k][d] = static_cast<double>(exact[i][k][d]);
      }
      batch.add(corners, static_cast<std::uint32_t>(i), 0);
    }
    batch.flush();
    for (const distance::PreparedTriangle& triangle : near) list.push_back(&triangle);
  }

  std::vector<lattice::LatticeTriangle> exact;
  std::vector<distance::PreparedTriangle> near;
  std::vector<const distance::PreparedTriangle*> list;
};

// The lowest voxel of a cell of the node.
Voxel random_cell(Random& random, std::int64_t edge) {
  Voxel low;
  for (std::int64_t& x : low) x = edge * whole(random, 0, 64 / edge - 1);
  return low;
}

distance::PointCube cube_at(const Voxel& low_voxel, int step_voxels) {
  distance::PointCube cube;
  cube.step = static_cast<float>(step_voxels) * kUnits;
  for (std::size_t d = 0; d < 3; ++d) {
    cube.first[d] = static_cast<float>(low_voxel[d]) * kUnits + cube.step / 2;
  }
  return cube;
}

double exact_voxels(const lattice::LatticeTriangle& triangle, const std::array<float, 3>& point) {
  return reference::point_distance(triangle,
                                   {point[0] / kUnits, point[1] / kUnits, point[2] / kUnits});
}

class TriangleDistances : public test::EveryTarget {};
INSTANTIATE_TEST_SUITE_P(Targets, TriangleDistances,
                         ::testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return hwy::TargetName(target.param); });

TEST_P(TriangleDistances, OfCellsAreWithinTheErrorThatTheSearchAllows) {
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const distance::PointCube cube =
        random() % 2 ? cube_at({0, 0, 0}, 16) : cube_at(random_cell(random, 16), 4);
    const Triangles triangles(random, static_cast<int>(whole(random, 1, 150)), {0, 0, 0}, 64, cube);
    std::vector<distance::CubeValues> squared(triangles.list.size());
    distance::CubeValues least;
    distance::squared_distances(triangles.list, cube, squared.data(), least);
    for (std::size_t n = 0; n < distance::kCubePoints; ++n) {
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

std::array<float, 2 * distance::kEighths> everywhere() {
  std::array<float, 2 * distance::kEighths> reach;
  reach.fill(kEverywhere);
  return reach;
}

// The least of two cubes' points from each triangle by itself, and which gives it.
struct OneByOne {
  OneByOne(const Triangles& triangles, const distance::PointCube& cube) {
    for (distance::CubeValues& values : least) values.fill(1e30f);
    for (std::uint32_t i = 0; i < triangles.list.size(); ++i) {
      one.find(distance::TriangleList(triangles.list).subspan(i, 1), cube, everywhere());
      for (std::size_t k = 0; k < 2; ++k) {
        for (std::size_t n = 0; n < distance::kCubePoints; ++n) {
          const float value = one.least(k)[n];
          std::uint32_t& best = which[k][n];
          if (value < least[k][n] ||
              (value == least[k][n] &&
               distance::lies_before(triangles.near[i], triangles.near[best]))) {
            least[k][n] = value;
            best = i;
          }
        }
      }
    }
  }
  distance::NearestTriangles one;
  std::array<distance::CubeValues, 2> least;
  std::array<std::array<std::uint32_t, distance::kCubePoints>, 2> which{};
};

// Leaving out what is farther than the least, and what is out of reach, changes no bit.
TEST_P(TriangleDistances, TheNearestIsThatOfTheTrianglesOneByOne) {
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    // In the cell and beside it, so that many triangles are about as near.
    const Voxel low = random_cell(random, 8);
    const distance::PointCube cube = cube_at(low, 1);
    const Triangles triangles(random, static_cast<int>(whole(random, 1, 150)),
                              {low[0] - whole(random, 0, 8), low[1], low[2]}, 8, cube);
    std::array<float, 2 * distance::kEighths> reach;
    for (float& r : reach) r = static_cast<float>(whole(random, -1, 12)) * kUnits;
    distance::NearestTriangles all, within;
    all.find(triangles.list, cube, everywhere());
    within.find(triangles.list, cube, reach);
    const OneByOne slow(triangles, cube);
    for (std::size_t k = 0; k < 2; ++k) {
      for (std::size_t n = 0; n < distance::kCubePoints; ++n) {
        ASSERT_EQ(all.least(k)[n], slow.least[k][n]) << "cube " << k << ", point " << n;
        ASSERT_EQ(all.which(k, n), slow.which[k][n]) << "cube " << k << ", point " << n;
        // Of every sixteenth the true distance too, which is slow.
        if (n % 16 == seed % 16) {
          std::array<float, 3> point = point_of(cube, n);
          if (k == 1) point[2] += 4 * kUnits;
          double truth = 1e30;
          for (const lattice::LatticeTriangle& triangle : triangles.exact) {
            truth = std::min(truth, exact_voxels(triangle, point));
          }
          EXPECT_NEAR(std::sqrt(slow.least[k][n]) / kUnits, truth, 1e-4);
        }
        std::size_t in = k * distance::kEighths;
        while ((distance::eighth(static_cast<unsigned>(in % distance::kEighths)) >> n & 1) == 0)
          ++in;
        if (std::sqrt(slow.least[k][n]) > reach[in]) continue;
        ASSERT_EQ(within.least(k)[n], slow.least[k][n]) << "cube " << k << ", point " << n;
        ASSERT_EQ(within.which(k, n), slow.which[k][n]) << "cube " << k << ", point " << n;
      }
    }
  }
}

// Nor does what the lists of the search leave out. Where it has no list nothing is in reach.
TEST_P(TriangleDistances, TheSearchLeavesNothingOutThatMatters) {
  constexpr std::array<float, 3> kReaches{1, 4, 9};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const Triangles triangles(random, 24, {0, 0, 0}, 64, cube_at(random_cell(random, 4), 1));
    const float reach = kReaches[seed - 1];
    std::array<float, 2 * distance::kEighths> reaches;
    reaches.fill(reach * kUnits);
    std::array<bool, 16 * 16 * 8> has_list{};
    const auto pair_at = [](int x, int y, int z) { return (x * 16 + y) * 8 + z; };
    const auto slow_at = [&](int x, int y, int z) {
      return OneByOne(triangles, distance::CellSearch::centers({4 * x, 4 * y, 8 * z}, 1));
    };
    distance::NearestTriangles nearest;
    distance::CellSearch().run(
        triangles.near, [&](const std::array<int, 3>&, int) { return reach; },
        [&](const std::array<int, 3>& low, distance::TriangleList list) {
          const int at[3] = {low[0] / 4, low[1] / 4, low[2] / 8};
          has_list[static_cast<std::size_t>(pair_at(at[0], at[1], at[2]))] = true;
          nearest.find(list, distance::CellSearch::centers(low, 1), reaches);
          const OneByOne slow = slow_at(at[0], at[1], at[2]);
          for (std::size_t k = 0; k < 2; ++k) {
            for (std::size_t n = 0; n < distance::kCubePoints; ++n) {
              if (std::sqrt(slow.least[k][n]) > reach * kUnits) continue;
              ASSERT_EQ(nearest.least(k)[n], slow.least[k][n])
                  << low[0] << ' ' << low[1] << ' ' << low[2];
              ASSERT_EQ(list[nearest.which(k, n)], triangles.list[slow.which[k][n]]);
            }
          }
        });
    for (int x = 0; x < 16; ++x) {
      for (int y = 0; y < 16; ++y) {
        for (int z = 0; z < 8; ++z) {
          if (has_list[static_cast<std::size_t>(pair_at(x, y, z))]) continue;
          const OneByOne slow = slow_at(x, y, z);
          for (const distance::CubeValues& least : slow.least) {
            EXPECT_GT(std::sqrt(*std::min_element(least.begin(), least.end())), reach * kUnits);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace forcelayer

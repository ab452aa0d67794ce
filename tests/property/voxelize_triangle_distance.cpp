// Finding the nearest triangle, on every width of vectors: the kernels against distances in
// doubles and against each triangle by itself, and the search from a node down to its cells.
#include "voxelize/distance/distance_kernel.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cfenv>
#include <cmath>
#include <map>
#include <vector>

#include "formats/lattice/voxel_overlap.h"
#include "tests/support/every_target.h"
#include "tests/support/reference_distance.h"
#include "tests/support/sanitized.h"
#include "tests/support/soups.h"
#include "voxelize/distance/lines_of_sight.h"
#include "voxelize/distance/triangle_search.h"
#include "voxelize/scan/snap.h"

namespace forcelayer {
namespace {

using distance::LinesOfSight;
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
  for (std::uint64_t seed = 1; seed <= 300; seed += test::seed_step(7)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const distance::PointCube cube =
        random() % 2 ? cube_at({0, 0, 0}, 16) : cube_at(random_cell(random, 16), 4);
    const Triangles triangles(random, static_cast<int>(whole(random, 1, 150)), {0, 0, 0}, 64, cube);
    std::vector<distance::CubeValues> squared(triangles.list.size());
    distance::CubeValues smallest;
    distance::squared_distances(triangles.list, cube, squared.data(), smallest);
    for (std::size_t n = 0; n < distance::kCubePoints; ++n) {
      float lowest = 1e30f;
      for (std::size_t i = 0; i < squared.size(); ++i) {
        // A tenth of what the search allows: the header's 1e-4.
        EXPECT_NEAR(std::sqrt(squared[i][n]) / kUnits,
                    exact_voxels(triangles.exact[i], point_of(cube, n)), 1e-4)
            << "point " << n << ", triangle " << i;
        lowest = std::min(lowest, squared[i][n]);
      }
      EXPECT_EQ(smallest[n], lowest);
    }
  }
}

using Cell = std::array<int, 3>;  // its lowest voxel

std::array<float, distance::kEighths> everywhere() {
  std::array<float, distance::kEighths> reach;
  reach.fill(kEverywhere);
  return reach;
}

// The least of a cell's voxels from each triangle by itself, and which gives it.
struct OneByOne {
  OneByOne(const std::vector<distance::PreparedTriangle>& near, const Cell& low) {
    smallest.fill(1e30f);
    for (std::uint32_t i = 0; i < near.size(); ++i) {
      const distance::PreparedTriangle* const triangle = &near[i];
      one.find(distance::TriangleList(&triangle, 1), low, everywhere());
      for (std::size_t n = 0; n < distance::kCubePoints; ++n) {
        const float value = one.smallest()[n];
        std::uint32_t& best = which[n];
        if (value < smallest[n] ||
            (value == smallest[n] && distance::lies_before(near[i], near[best]))) {
          smallest[n] = value;
          best = i;
        }
      }
    }
  }
  distance::NearestTriangles one;
  distance::CubeValues smallest;
  std::array<std::uint32_t, distance::kCubePoints> which{};
};

// Leaving out what is farther than the least, and what is out of reach, changes no bit.
TEST_P(TriangleDistances, TheNearestIsThatOfTheTrianglesOneByOne) {
  for (std::uint64_t seed = 1; seed <= 2000; seed += test::seed_step(11)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    // In the cell and beside it, so that many triangles are about as near.
    const Voxel low = random_cell(random, 4);
    const Cell cell{static_cast<int>(low[0]), static_cast<int>(low[1]), static_cast<int>(low[2])};
    const distance::PointCube cube = cube_at(low, 1);
    const Triangles triangles(random, static_cast<int>(whole(random, 1, 150)),
                              {low[0] - whole(random, 0, 8), low[1], low[2]}, 8, cube);
    std::array<float, distance::kEighths> reach;
    for (float& r : reach) r = static_cast<float>(whole(random, -1, 12)) * kUnits;
    distance::NearestTriangles all, within;
    all.find(triangles.list, cell, everywhere());
    within.find(triangles.list, cell, reach);
    const OneByOne slow(triangles.near, cell);
    for (std::size_t n = 0; n < distance::kCubePoints; ++n) {
      ASSERT_EQ(all.smallest()[n], slow.smallest[n]) << "point " << n;
      ASSERT_EQ(all.which(n), slow.which[n]) << "point " << n;
      // Every sixteenth is held to the true distance too, which is slow.
      if (n % 16 == seed % 16) {
        const std::array<float, 3> point = point_of(cube, n);
        double truth = 1e30;
        for (const lattice::LatticeTriangle& triangle : triangles.exact) {
          truth = std::min(truth, exact_voxels(triangle, point));
        }
        EXPECT_NEAR(std::sqrt(slow.smallest[n]) / kUnits, truth, 1e-4);
      }
      std::size_t in = 0;
      while ((distance::eighth(static_cast<unsigned>(in)) >> n & 1) == 0) ++in;
      if (std::sqrt(slow.smallest[n]) > reach[in]) continue;
      ASSERT_EQ(within.smallest()[n], slow.smallest[n]) << "point " << n;
      ASSERT_EQ(within.which(n), slow.which[n]) << "point " << n;
    }
  }
}

// The search finds in a cell what the triangles one by one give, within reach.
void expect_the_nearest(const std::vector<distance::PreparedTriangle>& near, const Cell& low,
                        distance::TriangleList list, float reach) {
  std::array<float, distance::kEighths> reaches;
  reaches.fill(reach * kUnits);
  const OneByOne slow(near, low);
  distance::NearestTriangles nearest;
  if (!list.empty()) nearest.find(list, low, reaches);
  for (std::size_t n = 0; n < distance::kCubePoints; ++n) {
    if (std::sqrt(slow.smallest[n]) > reach * kUnits) continue;
    ASSERT_FALSE(list.empty()) << low[0] << ' ' << low[1] << ' ' << low[2];
    ASSERT_EQ(nearest.smallest()[n], slow.smallest[n]) << low[0] << ' ' << low[1] << ' ' << low[2];
    ASSERT_EQ(list[nearest.which(n)], &near[slow.which[n]]);
  }
}

using Lists = std::map<Cell, std::vector<const distance::PreparedTriangle*>>;
Lists lists_of(const std::vector<distance::PreparedTriangle>& near, float reach) {
  Lists lists;
  distance::CellSearch().run(
      near, [&](const Cell&, int) { return reach; },
      [&](const Cell& low, distance::TriangleList list, distance::TriangleList) {
        lists[low].assign(list.begin(), list.end());
      });
  return lists;
}

// Nor does what the lists of the search leave out. Where it has no list nothing is in reach.
TEST_P(TriangleDistances, TheSearchLeavesNothingOutThatMatters) {
  constexpr std::array<float, 3> kReaches{1, 4, 9};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const Triangles triangles(random, 24, {0, 0, 0}, 64, cube_at(random_cell(random, 4), 1));
    const float reach = kReaches[seed - 1];
    Lists lists = lists_of(triangles.near, reach);
    for (int x = 0; x < 64; x += 4) {
      for (int y = 0; y < 64; y += 4) {
        for (int z = 0; z < 64; z += 4) {
          expect_the_nearest(triangles.near, {x, y, z}, lists[{x, y, z}], reach);
          if (HasFatalFailure()) return;
        }
      }
    }
  }
}

// A closed surface of revolution, turned and bent at random: spheres, cylinders with sharp rims,
// cones, their triangles smaller than a voxel or longer than a cell, and needles.
mesh::Mesh random_surface(Random& random) {
  const auto segments = static_cast<std::uint32_t>(whole(random, 3, 40));
  const double radius = reference::real(random, 0.5, 14);
  std::vector<std::array<double, 2>> profile;  // radius, height
  if (random() % 2 == 0) {
    const std::int64_t rings = whole(random, 2, 20);
    for (std::int64_t i = 1; i < rings; ++i) {
      const double angle = M_PI * static_cast<double>(i) / static_cast<double>(rings);
      profile.push_back({radius * std::sin(angle), -radius * std::cos(angle)});
    }
  } else {
    const double height = reference::real(random, 0.5, 30);
    const std::int64_t rings = whole(random, 2, 5);
    for (std::int64_t i = 0; i < rings; ++i) {
      profile.push_back({radius * reference::real(random, 0.95, 1),
                         height * (static_cast<double>(i) / static_cast<double>(rings - 1) - 0.5)});
    }
  }
  mesh::Mesh mesh;
  for (const auto& [r, h] : profile) {
    for (std::uint32_t i = 0; i < segments; ++i) {
      const double angle = 2 * M_PI * i / segments;
      mesh.vertices.push_back({r * std::cos(angle), r * std::sin(angle), h});
    }
  }
  const auto rings = static_cast<std::uint32_t>(profile.size());
  const auto poles = static_cast<std::uint32_t>(mesh.vertices.size());
  const double beyond = random() % 2 == 0 ? 0 : 0.05 * radius;
  mesh.vertices.push_back({0, 0, profile.front()[1] - beyond});
  mesh.vertices.push_back({0, 0, profile.back()[1] + beyond});
  for (std::uint32_t i = 0; i < segments; ++i) {
    const std::uint32_t j = (i + 1) % segments;
    mesh.triangles.push_back({poles, j, i});
    mesh.triangles.push_back({poles + 1, (rings - 1) * segments + i, (rings - 1) * segments + j});
    for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
      const std::uint32_t a = ring * segments + i, b = ring * segments + j;
      mesh.triangles.push_back({a, b, a + segments});
      mesh.triangles.push_back({b, b + segments, a + segments});
    }
  }
  constexpr std::array<double, 4> kBends{0, 0, 0.01, 0.2};
  const double bend = kBends[random() % 4];
  std::array<double, 4> q{};
  double squared = 0;
  for (double& c : q) c = reference::real(random, -1, 1), squared += c * c;
  for (double& c : q) c /= std::sqrt(squared);
  const auto [w, x, y, z] = q;
  const std::array<double, 9> axes{
      1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
      2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
      2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
  const bool along_the_grid = random() % 3 == 0;
  const double middle = reference::real(random, 30, 34);
  for (mesh::Vec3d& vertex : mesh.vertices) {
    const mesh::Vec3d from = vertex;
    for (std::size_t d = 0; d < 3; ++d) {
      if (!along_the_grid) {
        vertex[d] = axes[3 * d] * from[0] + axes[3 * d + 1] * from[1] + axes[3 * d + 2] * from[2];
      }
      vertex[d] += middle + bend * reference::real(random, -1, 1);
    }
  }
  return mesh;
}

// Some of the triangles left out, turned over, doubled, or with corners of their own.
void damage(Random& random, mesh::Mesh& mesh) {
  std::vector<mesh::Triangle> kept;
  for (mesh::Triangle triangle : mesh.triangles) {
    const auto fate = random() % 40;
    if (fate == 0) continue;
    if (fate == 1) std::swap(triangle[0], triangle[1]);
    if (fate == 2) kept.push_back(triangle);
    if (fate > 30) {
      for (std::uint32_t& corner : triangle) {
        mesh.vertices.push_back(mesh.vertices[corner]);
        corner = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
      }
    }
    kept.push_back(triangle);
  }
  mesh.triangles = kept;
}

// How many triangles are within a cell's size of the one nearest to its middle.
std::size_t count_by_middle(const std::vector<distance::PreparedTriangle>& near, const Cell& low) {
  std::vector<const distance::PreparedTriangle*> list;
  for (const distance::PreparedTriangle& triangle : near) list.push_back(&triangle);
  std::vector<distance::CubeValues> squared(list.size());
  distance::PointCube middle = cube_at({low[0], low[1], low[2]}, 4);
  middle.step = 0;
  distance::CubeValues smallest;
  distance::squared_distances(list, middle, squared.data(), smallest);
  const float largest = std::sqrt(smallest[0]) + 2 * distance::half_diagonal(4) * kUnits;
  return static_cast<std::size_t>(std::count_if(
      squared.begin(), squared.end(),
      [&](const distance::CubeValues& values) { return values[0] <= largest * largest; }));
}

// A triangle that another one beats in all of a cell is left out of its list, and changes no bit.
TEST_P(TriangleDistances, OfSurfacesTheListsAreShort) {
  std::size_t near_cells = 0, listed = 0, by_middle = 0, surfaces = 0;
  for (std::uint64_t seed = 1; seed <= 60; seed += test::seed_step(7)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    mesh::Mesh mesh = random_surface(random);
    ++surfaces;
    if (random() % 3 == 0) damage(random, mesh);
    auto object = scan::snap_object(mesh, {}, 1, "surface");
    ASSERT_TRUE(object);
    const int reach = static_cast<int>(whole(random, 2, 7));
    const distance::SceneTriangles triangles({&*object}, reach + 1);
    std::vector<distance::PreparedTriangle> near;
    triangles.gather({0, 0, 0}, near);
    ASSERT_EQ(near.size(), mesh.triangles.size());
    for (const auto& [low, list] : lists_of(near, static_cast<float>(reach))) {
      if (random() % 24 != 0) continue;
      ++near_cells;
      listed += list.size();
      by_middle += count_by_middle(near, low);
      expect_the_nearest(near, low, list, static_cast<float>(reach));
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(near_cells, 8 * surfaces);
  EXPECT_LT(listed, by_middle / 2) << "hardly anything is left out";
}

TEST(TriangleSearch, PiecesWithoutAreaBecomeTheirLongestEdge) {
  using Piece = std::array<std::array<double, 3>, 3>;
  const auto flattened = [](Piece piece) {
    distance::flatten_if_thin(piece);
    return piece;
  };
  const Piece sound{{{0, 0, 0}, {9, 0, 0}, {0, 1, 0}}};
  EXPECT_EQ(flattened(sound), sound);
  const Piece row{{{0, 0, 0}, {9, 0, 0}, {4, 1e-9, 0}}};
  EXPECT_EQ(flattened(row), (Piece{row[0], row[1], row[0]}));
  const Piece point{{{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}};
  std::feclearexcept(FE_INVALID);
  EXPECT_EQ(flattened(point), point);
  EXPECT_EQ(std::fetestexcept(FE_INVALID), 0) << "0/0";
}

// Triangles too large for single precision are cut to what is near a node. Where one of their edges
// passes through an edge of the box to which they are cut, two corners of a piece lie at one place
// but for rounding; the others have corners on whole voxels and on the planes of that box. Once a
// piece without area was as near as the rounding of its normal said.
TEST_P(TriangleDistances, OfLargeTrianglesThePiecesAreAsFarAsTheWhole) {
  constexpr int kReach = 6;
  std::size_t near_points = 0, pieces = 0;
  for (std::uint64_t seed = 1; seed <= 1200; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    mesh::Mesh mesh;
    for (int k = 0; k < 3; ++k) {
      std::array<double, 3> corner;
      for (double& x : corner) {
        const std::int64_t places[] = {-kReach - 1, 64 + kReach + 1, whole(random, -20, 80),
                                       whole(random, -300, 300)};
        x = static_cast<double>(places[whole(random, 0, 3)]);
        if (random() % 4 == 0) x += static_cast<double>(whole(random, 0, 1023)) / 1024;
      }
      mesh.vertices.push_back(corner);
    }
    if (random() % 2 == 0) {
      const auto free_axis = static_cast<std::size_t>(whole(random, 0, 2));
      for (std::size_t d = 0; d < 3; ++d) {
        const double bound = random() % 2 == 0 ? -kReach - 1 : 64 + kReach + 1;
        const double at = d == free_axis ? static_cast<double>(whole(random, 0, 64)) : bound;
        const auto way = static_cast<double>(whole(random, -50, 50));
        mesh.vertices[0][d] = at - 3 * way;
        mesh.vertices[1][d] = at + 4 * way;
      }
    }
    mesh.triangles = {{0, 1, 2}};
    auto object = scan::snap_object(mesh, {}, 1, "large");
    ASSERT_TRUE(object);
    const distance::SceneTriangles triangles({&*object}, kReach);
    std::vector<distance::PreparedTriangle> near;
    triangles.gather({0, 0, 0}, near);
    if (near.empty()) continue;
    pieces += near.size() - 1;
    std::vector<const distance::PreparedTriangle*> list;
    for (const distance::PreparedTriangle& piece : near) list.push_back(&piece);
    std::vector<distance::CubeValues> squared(list.size());
    for (int cell = 0; cell < 64; ++cell) {
      const distance::PointCube cube =
          cube_at({16 * (cell >> 4), 16 * (cell >> 2 & 3), 16 * (cell & 3)}, 4);
      distance::CubeValues smallest;
      distance::squared_distances(list, cube, squared.data(), smallest);
      for (std::size_t n = 0; n < distance::kCubePoints; ++n) {
        const double exact = exact_voxels(object->triangle(0), point_of(cube, n));
        const double found = std::sqrt(double{smallest[n]}) / kUnits;
        ASSERT_GT(found, exact - 2e-4) << "cell " << cell << ", point " << n;
        if (exact > kReach) continue;
        ++near_points;
        ASSERT_LT(found, exact + 2e-4) << "cell " << cell << ", point " << n;
      }
    }
  }
  EXPECT_GT(near_points, 40000u);
  EXPECT_GT(pieces, 600u);
}

// The distance of a triangle from a line between two points, voxels: along the line the distance
// from a convex set is convex.
double line_distance(const lattice::LatticeTriangle& triangle, const reference::Point& from,
                     const reference::Point& to) {
  double low = 0, high = 1;
  const auto at = [&](double t) {
    return reference::point_distance(triangle, reference::between(from, to, t));
  };
  for (int n = 0; n < 100; ++n) {
    const double third = (high - low) / 3;
    if (at(low + third) <= at(high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  return at((low + high) / 2);
}

// How far from a triangle a line may be that counts as crossing it, at most, voxels: by as much as
// it touches the triangle's plane (lines_of_sight.cpp).
double max_touching(const lattice::LatticeTriangle& t, const LinesOfSight::Offset& way) {
  std::array<double, 3> normal{};
  double square = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::size_t e = (d + 1) % 3, f = (d + 2) % 3;
    normal[d] = static_cast<double>((t[1][e] - t[0][e]) * (t[2][f] - t[0][f]) -
                                    (t[1][f] - t[0][f]) * (t[2][e] - t[0][e]));
    square += normal[d] * normal[d];
  }
  double fall = 0, length = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    if (square > 0) fall += normal[d] * way[d] / std::sqrt(square);
    length += way[d] * way[d];
  }
  constexpr double kTouching = distance::kKernelErrorVoxels;
  // A triangle without area has any plane through it.
  const double fraction =
      square > 0 ? std::min(1.0, 2.1 * kTouching / std::max(std::abs(fall), 1e-9)) : 1;
  return 2 * kTouching + std::sqrt(length) * fraction;
}

// A free line is at least this far from a triangle, voxels: the threshold less the kernels' error.
constexpr double kMinFree = 0.9 * double{distance::kKernelErrorVoxels};

std::vector<LinesOfSight::Offset> any_offsets(Random& random) {
  std::vector<LinesOfSight::Offset> offsets(
      static_cast<std::size_t>(whole(random, 1, LinesOfSight::kMaxLines)));
  for (LinesOfSight::Offset& offset : offsets) {
    for (std::int8_t& step : offset) {
      step = static_cast<std::int8_t>(whole(random, -LinesOfSight::kFar, LinesOfSight::kFar));
    }
  }
  return offsets;
}

TEST_P(TriangleDistances, AFreeLineCrossesNoTriangle) {
  int crossing = 0, free = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const Voxel voxel = random_cell(random, 1);
    std::array<int, 3> from{};
    lattice::LatticePoint near_voxel;
    for (std::size_t d = 0; d < 3; ++d) {
      from[d] = static_cast<int>(voxel[d]);
      near_voxel[d] = voxel[d] * lattice::kSnapUnits + whole(random, -2048, 3072);
    }
    const lattice::LatticeTriangle exact = any_triangle(random, near_voxel);
    std::array<std::array<double, 3>, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t d = 0; d < 3; ++d) corners[k][d] = static_cast<double>(exact[k][d]);
    }
    std::vector<distance::PreparedTriangle> prepared;
    distance::TriangleBatch batch(prepared);
    batch.add(corners, 0, 0);
    batch.flush();
    const distance::PreparedTriangle* const list[] = {prepared.data()};
    const auto offsets = any_offsets(random);
    const std::uint32_t found = distance::free_lines(list, from, offsets);
    for (std::size_t n = 0; n < offsets.size(); ++n) {
      const reference::Point begin = reference::center_of(voxel);
      reference::Point end = begin;
      for (std::size_t d = 0; d < 3; ++d) end[d] += offsets[n][d];
      const double smallest = line_distance(exact, begin, end);
      if ((found >> n & 1) != 0) {
        ASSERT_GT(smallest, kMinFree) << "line " << n;
        ++free;
      } else {
        ASSERT_LT(smallest, max_touching(exact, offsets[n]) + 1e-4) << "line " << n;
        ++crossing;
      }
    }
    ASSERT_EQ(found >> offsets.size(), 0u);
  }
  EXPECT_GT(crossing, 500);
  EXPECT_GT(free, 1000);
}

TEST_P(TriangleDistances, LinesOfSightLeaveNoTriangleOut) {
  LinesOfSight sight;
  std::uint64_t seen = 0, hidden = 0, scenes = 0;
  for (std::uint64_t seed = 1; seed <= 60; seed += test::seed_step(7)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const Triangles triangles(random, static_cast<int>(whole(random, 1, 300)), {0, 0, 0}, 64,
                              cube_at(random_cell(random, 4), 1));
    sight.begin_node();
    ++scenes;
    for (int n = 0; n < 200; ++n) {
      const Voxel low = random_cell(random, 4);
      const std::array<int, 3> cell{static_cast<int>(low[0]), static_cast<int>(low[1]),
                                    static_cast<int>(low[2])};
      for (int i = 0; i < 4; ++i) {
        std::array<int, 3> voxel = cell;
        for (int& x : voxel) x += static_cast<int>(whole(random, 0, 3));
        sight.begin(cell, triangles.list, voxel);
        const auto offsets = any_offsets(random);
        const std::uint32_t found = sight.free(offsets);
        const std::uint32_t all = distance::free_lines(triangles.list, voxel, offsets);
        ASSERT_EQ(found & all, all);
        // A flat line may count as crossing a triangle beside its box, which is not listed.
        for (std::uint32_t more = found & ~all; more != 0; more &= more - 1) {
          const auto line = static_cast<std::size_t>(std::countr_zero(more));
          const reference::Point begin = reference::center_of({voxel[0], voxel[1], voxel[2]});
          reference::Point end = begin;
          for (std::size_t d = 0; d < 3; ++d) end[d] += offsets[line][d];
          for (const lattice::LatticeTriangle& exact : triangles.exact) {
            ASSERT_GT(line_distance(exact, begin, end), kMinFree);
          }
        }
        seen += static_cast<std::uint64_t>(std::popcount(found));
        hidden += offsets.size() - static_cast<std::uint64_t>(std::popcount(found));
      }
    }
  }
  EXPECT_GT(seen, 170 * scenes);
  EXPECT_GT(hidden, 170 * scenes);
}

}  // namespace
}  // namespace forcelayer

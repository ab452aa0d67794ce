// The bit-parallel overlap test against exact elimination, voxel by voxel.
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <random>
#include <set>

#include "formats/lattice/voxel_overlap.h"
#include "tests/support/exact_overlap.h"
#include "tests/support/soups.h"

namespace forcelayer {
namespace {

__extension__ typedef __int128 Int128;
using Wide = boost::multiprecision::number<boost::multiprecision::cpp_int_backend<
    512, 512, boost::multiprecision::signed_magnitude, boost::multiprecision::unchecked, void>>;
using reference::Random;
using reference::whole;

// A vertex with `grid` units between possible coordinates, within `extent` units of `center`.
lattice::LatticePoint random_point(Random& random, const lattice::LatticePoint& center,
                                   std::int64_t extent, std::int64_t grid) {
  lattice::LatticePoint point;
  for (std::size_t d = 0; d < 3; ++d) {
    point[d] = center[d] + whole(random, -extent / grid, extent / grid) * grid;
  }
  return point;
}

// Kinds of triangles that the world's mesh files throw at a scan converter.
enum class Shape {
  kPlain,
  kOnGrid,
  kHalfGrid,
  kFlat,
  kSliver,
  kSegment,
  kPoint,
  kNearlyFlat,
  kCount
};

lattice::LatticeTriangle random_triangle(Random& random, std::int64_t extent, Shape shape) {
  const lattice::LatticePoint center = random_point(random, {0, 0, 0}, 5000000, 1);
  std::int64_t grid = 1;
  if (shape == Shape::kOnGrid) grid = lattice::kSnapUnits;
  if (shape == Shape::kHalfGrid) grid = lattice::kSnapUnits / 2;
  lattice::LatticePoint base = center;
  if (grid > 1) {
    for (auto& x : base) x = x / grid * grid;
  }
  lattice::LatticeTriangle triangle;
  for (auto& point : triangle) point = random_point(random, base, extent, grid);
  const auto axis = static_cast<std::size_t>(whole(random, 0, 2));
  if (shape == Shape::kFlat) {  // in a plane of voxel faces, or of lattice points next to it
    const std::int64_t plane =
        (center[axis] >> lattice::kSnapBits << lattice::kSnapBits) + whole(random, -1, 1);
    for (auto& point : triangle) point[axis] = plane;
  }
  if (shape == Shape::kNearlyFlat) {
    const std::int64_t plane = center[axis] >> lattice::kSnapBits << lattice::kSnapBits;
    for (auto& point : triangle) point[axis] = plane + whole(random, -1, 1);
  }
  if (shape == Shape::kSliver) {
    for (std::size_t d = 0; d < 3; ++d) triangle[2][d] = triangle[1][d] + whole(random, -2, 2);
  }
  if (shape == Shape::kSegment) {  // collinear, the third corner between, beyond or on an end
    const std::int64_t times = whole(random, -1, 2);
    for (std::size_t d = 0; d < 3; ++d) {
      triangle[2][d] = triangle[0][d] + times * (triangle[1][d] - triangle[0][d]);
    }
  }
  if (shape == Shape::kPoint) triangle[1] = triangle[2] = triangle[0];
  return triangle;
}

// Every voxel of the triangle's box and of one layer around it, by elimination.
std::set<lattice::VoxelIndex> reference_voxels(const lattice::LatticeTriangle& triangle) {
  const lattice::TriangleOverlap box(triangle);
  std::set<lattice::VoxelIndex> voxels;
  for (std::int64_t x = box.min_voxel()[0] - 1; x <= box.max_voxel()[0] + 1; ++x) {
    for (std::int64_t y = box.min_voxel()[1] - 1; y <= box.max_voxel()[1] + 1; ++y) {
      for (std::int64_t z = box.min_voxel()[2] - 1; z <= box.max_voxel()[2] + 1; ++z) {
        if (reference::overlaps_cell<Int128>(triangle, {x, y, z})) voxels.insert({x, y, z});
      }
    }
  }
  return voxels;
}

class VoxelOverlap : public testing::TestWithParam<Shape> {};

void expect_exact(const lattice::LatticeTriangle& triangle) {
  const std::vector<lattice::VoxelIndex> found = lattice::overlapped_voxels(triangle);
  const std::set<lattice::VoxelIndex> unique(found.begin(), found.end());
  ASSERT_EQ(found.size(), unique.size()) << "a voxel came twice";
  ASSERT_EQ(unique, reference_voxels(triangle));
}

TEST_P(VoxelOverlap, EqualsEliminationOnEveryVoxel) {
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const std::int64_t extent = lattice::kSnapUnits / 8 << whole(random, 0, 5);
    expect_exact(random_triangle(random, extent, GetParam()));
    if (HasFatalFailure()) return;
  }
}

TEST_P(VoxelOverlap, CellsOfAnySizeAtAnyCornerEqualElimination) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const int log2_cell = static_cast<int>(whole(random, 0, 7));
    const lattice::LatticeTriangle triangle =
        random_triangle(random, lattice::kSnapUnits << whole(random, 0, log2_cell + 3), GetParam());
    const lattice::TriangleOverlap overlap(triangle);
    lattice::VoxelIndex corner;
    for (std::size_t d = 0; d < 3; ++d) {
      corner[d] = whole(random, overlap.min_voxel()[d] - (6 << log2_cell), overlap.max_voxel()[d]);
    }
    const lattice::BrickMask mask = overlap.cells(corner, log2_cell);
    for (unsigned x = 0; x < 8; ++x) {
      for (unsigned y = 0; y < 8; ++y) {
        for (unsigned z = 0; z < 8; ++z) {
          const lattice::VoxelIndex cell = {corner[0] + (std::int64_t{x} << log2_cell),
                                            corner[1] + (std::int64_t{y} << log2_cell),
                                            corner[2] + (std::int64_t{z} << log2_cell)};
          ASSERT_EQ(mask.test(x, y, z),
                    reference::overlaps_cell<Int128>(triangle, cell, std::int64_t{1} << log2_cell))
              << x << ' ' << y << ' ' << z << " log2_cell " << log2_cell;
        }
      }
    }
  }
}

// Triangles of up to 2^31 voxels across: the widths of the arithmetic change at 2^19 and 2^28
// units.
TEST_P(VoxelOverlap, HugeTrianglesAreExactNearTheirCorners) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const int log2_extent = static_cast<int>(whole(random, 17, 40));
    SCOPED_TRACE(testing::Message() << "seed " << seed << " log2_extent " << log2_extent);
    lattice::LatticeTriangle triangle =
        random_triangle(random, std::int64_t{1} << (log2_extent - 1), GetParam());
    const lattice::TriangleOverlap overlap(triangle);
    for (int window = 0; window < 4; ++window) {
      lattice::VoxelIndex corner;  // near a point of the triangle
      const double s = whole(random, 0, 1000) / 1000.0, t = (1 - s) * whole(random, 0, 1000) / 1000;
      for (std::size_t d = 0; d < 3; ++d) {
        const double offset = s * static_cast<double>(triangle[1][d] - triangle[0][d]) +
                              t * static_cast<double>(triangle[2][d] - triangle[0][d]);
        corner[d] =
            ((triangle[0][d] + std::llrint(offset)) >> lattice::kSnapBits) - whole(random, 0, 7);
      }
      const lattice::BrickMask mask = overlap.cells(corner);
      for (int sample = 0; sample < 64; ++sample) {
        const auto x = static_cast<unsigned>(whole(random, 0, 7));
        const auto y = static_cast<unsigned>(whole(random, 0, 7));
        const auto z = static_cast<unsigned>(whole(random, 0, 7));
        ASSERT_EQ(mask.test(x, y, z), reference::overlaps_cell<Wide>(
                                          triangle, {corner[0] + x, corner[1] + y, corner[2] + z}));
      }
    }
  }
}

// Corner order and whole-voxel shifts do not matter; the neighbors of a shared edge agree on it.
TEST_P(VoxelOverlap, IsInvariantUnderCornerOrderAndWholeVoxelShifts) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const lattice::LatticeTriangle triangle =
        random_triangle(random, 12 * lattice::kSnapUnits, GetParam());
    std::vector<lattice::VoxelIndex> expected = lattice::overlapped_voxels(triangle);
    std::sort(expected.begin(), expected.end());
    for (const auto& order : {std::array<std::size_t, 3>{1, 2, 0}, {2, 1, 0}, {0, 2, 1}}) {
      auto found =
          lattice::overlapped_voxels({triangle[order[0]], triangle[order[1]], triangle[order[2]]});
      std::sort(found.begin(), found.end());
      ASSERT_EQ(found, expected);
    }
    lattice::VoxelIndex shift;
    for (auto& x : shift) x = whole(random, -(std::int64_t{1} << 50), std::int64_t{1} << 50);
    lattice::LatticeTriangle moved = triangle;
    for (auto& point : moved) {
      for (std::size_t d = 0; d < 3; ++d) point[d] += shift[d] * lattice::kSnapUnits;
    }
    auto found = lattice::overlapped_voxels(moved);
    std::sort(found.begin(), found.end());
    for (auto& voxel : found) {
      for (std::size_t d = 0; d < 3; ++d) voxel[d] -= shift[d];
    }
    ASSERT_EQ(found, expected);
  }
}

std::string shape_name(const testing::TestParamInfo<Shape>& info) {
  constexpr const char* kNames[] = {"Plain",  "OnGrid",  "HalfGrid", "Flat",
                                    "Sliver", "Segment", "Point",    "NearlyFlat"};
  return kNames[static_cast<int>(info.param)];
}

INSTANTIATE_TEST_SUITE_P(Shapes, VoxelOverlap,
                         testing::Values(Shape::kPlain, Shape::kOnGrid, Shape::kHalfGrid,
                                         Shape::kFlat, Shape::kSliver, Shape::kSegment,
                                         Shape::kPoint, Shape::kNearlyFlat),
                         shape_name);

TEST(VoxelOverlapUnit, AFaceOnVoxelFacesMarksOneLayer) {
  const std::int64_t u = lattice::kSnapUnits;
  const auto voxels = lattice::overlapped_voxels({{{0, 0, 0}, {4 * u, 0, 0}, {0, 4 * u, 0}}});
  for (const lattice::VoxelIndex& voxel : voxels) EXPECT_EQ(voxel[2], 0);
  EXPECT_EQ(voxels.size(),
            15u);  // 10 with area; the closed hypotenuse and the far corners touch 5 more
}

TEST(VoxelOverlapUnit, SnapRoundsToTheNearestLatticePoint) {
  EXPECT_EQ(lattice::snap({0.0, 1.0, -1.0}, 1.0), (lattice::LatticePoint{0, 1024, -1024}));
  EXPECT_EQ(lattice::snap({0.5e-3, -0.26e-3, 1e5}, 1e-3),
            (lattice::LatticePoint{512, -266, 102400000000}));
}

}  // namespace
}  // namespace forcelayer

// The connected pieces of an interior against a plain walk from voxel to voxel.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/support/reference_bake.h"
#include "tests/support/sanitized.h"
#include "tests/support/soups.h"
#include "voxelize/bake.h"

namespace forcelayer {
namespace {

using reference::DenseGrid;
using reference::Random;
using reference::real;
using reference::whole;

voxelize::ObjectReport report_of(const mesh::Mesh& mesh, const voxelize::BakeOptions& options) {
  const std::vector<voxelize::SceneObject> objects = {{"object", &mesh, mesh::Affine{}, {}, 0}};
  const auto result = voxelize::bake(objects, options);
  if (!result) throw std::runtime_error(to_line(result.error()));
  return result->objects.front();
}

voxelize::BakeOptions cavity_options() {
  voxelize::BakeOptions options;
  options.voxel_size_m = 1;
  options.threads = 2;
  options.find_cavities = true;
  return options;
}

// Marks the 6-connected piece of 1s around `start` with `label`; how many voxels it has.
std::uint64_t mark_piece(DenseGrid& grid, const lattice::VoxelIndex& start, std::uint8_t label) {
  std::vector<lattice::VoxelIndex> stack = {start};
  std::uint64_t voxels = 0;
  while (!stack.empty()) {
    const lattice::VoxelIndex v = stack.back();
    stack.pop_back();
    if (!grid.contains(v) || grid.at(v) != 1) continue;
    grid.at(v) = label;
    ++voxels;
    for (std::size_t d = 0; d < 3; ++d) {
      for (const std::int64_t step : {-1, 1}) {
        lattice::VoxelIndex next = v;
        next[d] += step;
        stack.push_back(next);
      }
    }
  }
  return voxels;
}

TEST(Cavities, AreThePiecesOfTheInterior) {
  std::size_t pieces = 0;
  for (std::uint64_t seed = 1; seed <= 30; seed += test::seed_step(7)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    mesh::Mesh mesh;
    mesh::Vec3d place;
    for (double& x : place) x = static_cast<double>(whole(random, -2, 2) * 512);
    const double extent = real(random, 5, seed % 5 == 0 ? 110 : 50);
    for (std::int64_t n = whole(random, 1, 4); n > 0; --n) {  // one object of several
      mesh::Vec3d center = place;
      for (double& x : center) x += real(random, -extent / 3, extent / 3);
      const mesh::Mesh part = reference::random_object(random, center, extent);
      for (const mesh::Triangle& t : part.triangles) {
        reference::add_triangle(mesh, part.vertices[t[0]], part.vertices[t[1]],
                                part.vertices[t[2]]);
      }
    }
    const auto scene =
        reference::united_scene({reference::snapped(mesh, mesh::Affine{}, 1)}, {}, 2);
    DenseGrid grid = scene.interior;
    std::map<std::uint8_t, std::uint64_t> sizes;
    std::uint8_t label = 2;
    grid.for_each([&](const lattice::VoxelIndex& v) {
      if (grid.at(v) != 1 || label == 255) return;
      sizes[label] = mark_piece(grid, v, label);
      ++label;
    });
    if (label == 255) continue;  // more pieces than this test can tell apart
    const voxelize::ObjectReport report = report_of(mesh, cavity_options());
    ASSERT_EQ(report.cavity_count, sizes.size());
    std::uint64_t last = UINT64_MAX;
    for (const fill::Cavity& cavity : report.cavities) {
      ASSERT_TRUE(grid.contains(cavity.seed_voxel));
      const auto found = sizes.find(grid.at(cavity.seed_voxel));
      ASSERT_NE(found, sizes.end()) << "a seed outside every piece, or two in one";
      ASSERT_EQ(cavity.voxels, found->second);
      ASSERT_LE(cavity.voxels, last) << "not the largest first";
      last = cavity.voxels;
      sizes.erase(found);
      ++pieces;
    }
  }
  EXPECT_GT(pieces, 30 / test::seed_step(7)) << "the test has lost its cavities";
}

// Pieces of whole nodes and blocks, and a wall between two.
TEST(Cavities, LargeOnesAreOneEach) {
  mesh::Mesh mesh;
  reference::add_box(mesh, {-30, -30, -30}, {1060.5, 530.5, 530.5});
  reference::add_box(mesh, {100, 100, 100}, {750.5, 300.5, 300.5});
  const voxelize::ObjectReport report = report_of(mesh, cavity_options());
  ASSERT_EQ(report.cavity_count, 2u);
  const std::uint64_t inner = 649u * 199 * 199, outer = 1089ull * 559 * 559;
  EXPECT_EQ(report.cavities[0].voxels, outer - 651ull * 201 * 201);
  EXPECT_EQ(report.cavities[1].voxels, inner);
}

// Opening a cavity from its seed empties it and nothing else.
TEST(Cavities, TheirSeedsOpenThem) {
  mesh::Mesh mesh;
  reference::add_box(mesh, {0, 0, 0}, {30, 30, 30});
  reference::add_box(mesh, {50, 0, 0}, {60, 10, 10});
  voxelize::BakeOptions options = cavity_options();
  const voxelize::ObjectReport closed = report_of(mesh, options);
  ASSERT_EQ(closed.cavities.size(), 2u);
  for (const fill::Cavity& cavity : closed.cavities) {
    mesh::Vec3d seed_m;
    for (std::size_t d = 0; d < 3; ++d) {
      seed_m[d] = static_cast<double>(cavity.seed_voxel[d]) + 0.5;
    }
    voxelize::BakeOptions opened = options;
    opened.free_seeds_m = {seed_m};
    EXPECT_EQ(report_of(mesh, opened).interior_voxels, closed.interior_voxels - cavity.voxels);
  }
}

// A box with a slit of 0.6 voxels: closed at this voxel size, open at half of it.
TEST(Cavities, NarrowPassagesOpenAtHalfTheVoxelSize) {
  mesh::Mesh mesh;
  reference::add_box(mesh, {0, 0, 0}, {20, 20, 20}, 1u << 5);  // the far z face is missing ...
  const double slit = 9.95;
  reference::add_box(mesh, {0, 0, 20}, {slit, 20, 20});  // ... and closed but for a slit
  reference::add_box(mesh, {slit + 0.6, 0, 20}, {20, 20, 20});
  mesh::Mesh sealed;
  reference::add_box(sealed, {100, 0, 0}, {120, 20, 20});
  for (const mesh::Triangle& t : sealed.triangles) {
    reference::add_triangle(mesh, sealed.vertices[t[0]], sealed.vertices[t[1]],
                            sealed.vertices[t[2]]);
  }
  voxelize::BakeOptions options = cavity_options();
  options.find_narrow_passages = true;
  const voxelize::ObjectReport report = report_of(mesh, options);
  ASSERT_EQ(report.cavities.size(), 2u);
  for (const fill::Cavity& cavity : report.cavities) {
    EXPECT_EQ(cavity.opens_at_half_size, cavity.seed_voxel[0] < 50);
  }
}

}  // namespace
}  // namespace forcelayer

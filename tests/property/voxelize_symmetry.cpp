// Whole bakes under symmetries of the lattice: the same voxels, moved along.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/baked_scene.h"
#include "tests/support/lattice_symmetry.h"
#include "tests/support/sanitized.h"
#include "tests/support/soups.h"

namespace forcelayer {
namespace {

using reference::BakedScene;
using reference::DenseGrid;
using reference::LatticeMesh;
using reference::objects_of;
using reference::options_with;
using reference::Random;
using reference::real;
using reference::Symmetry;
using reference::whole;

// Meshes in voxels of 1 m, on the snapping lattice, so that moving them rounds nothing.
std::vector<mesh::Mesh> lattice_scene(Random& random, double extent) {
  std::vector<mesh::Mesh> meshes;
  for (std::int64_t n = whole(random, 1, 3); n > 0; --n) {
    mesh::Vec3d center;
    for (double& x : center) x = real(random, -extent / 3, extent / 3);
    mesh::Mesh& mesh = meshes.emplace_back(reference::random_object(random, center, extent));
    for (mesh::Vec3d& vertex : mesh.vertices) {
      for (double& x : vertex) x = std::round(x * lattice::kSnapUnits) / lattice::kSnapUnits;
    }
  }
  return meshes;
}

TEST(BakeSymmetry, TurnedAndMirroredReferencesAgree) {
  const std::vector<Symmetry> all = reference::symmetries();
  ASSERT_EQ(all.size(), 48u);
  for (std::uint64_t seed = 1; seed <= 48; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const std::vector<mesh::Mesh> meshes = lattice_scene(random, 10);
    std::vector<LatticeMesh> lattice;
    for (const mesh::Mesh& mesh : meshes)
      lattice.push_back(reference::snapped(mesh, mesh::Affine{}, 1));
    const int layers = static_cast<int>(whole(random, 0, 2));
    const Symmetry& symmetry = all[seed - 1];
    const DenseGrid moved = reference::moved_reference(lattice, symmetry, layers);
    const BakedScene baked(objects_of(meshes), options_with(static_cast<std::uint32_t>(layers)));
    std::uint64_t wrong = 0, held = 0;
    reference::grid_around(lattice, layers + 2).for_each([&](const lattice::VoxelIndex& v) {
      const auto value = static_cast<std::uint8_t>(baked.map().value(v[0], v[1], v[2]));
      wrong += value != moved.at(symmetry.voxel(v));
      held += value != 0;
    });
    ASSERT_EQ(wrong, 0u);
    ASSERT_GT(held, 0u);
  }
}

// The same tree elsewhere: shifts by whole blocks change the origin alone.
TEST(BakeSymmetry, ShiftsByWholeVoxels) {
  for (std::uint64_t seed = 1; seed <= 20; seed += test::seed_step(3)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const std::vector<mesh::Mesh> meshes = lattice_scene(random, 40);
    const BakedScene baked(objects_of(meshes), options_with(2));
    const VoxmapHeader& header = baked.map().header();
    // Near, 1e5 m away, and far enough that a voxel is a small part of a coordinate.
    for (const std::int64_t far : {3, 700, 100'000, 1'000'000'000}) {
      lattice::VoxelIndex shift;
      for (std::int64_t& x : shift) x = whole(random, -far, far);
      mesh::Affine placing;
      for (std::size_t d = 0; d < 3; ++d) placing.translation[d] = static_cast<double>(shift[d]);
      const BakedScene moved(objects_of(meshes, placing), options_with(2));
      const VoxmapHeader& other = moved.map().header();
      std::uint64_t wrong = 0;
      lattice::VoxelIndex low, high;
      for (std::size_t d = 0; d < 3; ++d) {
        ASSERT_EQ(other.origin_voxel[d], header.origin_voxel[d] + shift[d]);
        low[d] = header.origin_voxel[d] - 1;
        high[d] = header.origin_voxel[d] + static_cast<std::int64_t>(header.dims_voxels[d]);
      }
      ASSERT_EQ(other.dims_voxels, header.dims_voxels);
      DenseGrid(low, high).for_each([&](const lattice::VoxelIndex& v) {
        wrong += moved.map().value(v[0] + shift[0], v[1] + shift[1], v[2] + shift[2]) !=
                 baked.map().value(v[0], v[1], v[2]);
      });
      ASSERT_EQ(wrong, 0u) << "shifted by up to " << far;
    }
  }
}

// A scene 1e5 m from the origin with voxels of 5 mm, placed by its transform: exact to the voxel.
TEST(BakeSymmetry, FarFromTheOriginInMillimetres) {
  Random random(11);
  const std::vector<mesh::Mesh> meshes = lattice_scene(random, 40);  // in voxels
  const double size = 1.0 / 256;  // of about 4 mm, exact in binary
  mesh::Affine near_placing, far_placing;
  near_placing.linear = far_placing.linear = {size, 0, 0, 0, size, 0, 0, 0, size};
  far_placing.translation = {1e5, -1e5, 1e5};
  voxelize::BakeOptions options = options_with(2);
  options.voxel_size_m = size;
  const BakedScene near(objects_of(meshes, near_placing), options);
  const BakedScene far(objects_of(meshes, far_placing), options);
  const VoxmapHeader& header = near.map().header();
  lattice::VoxelIndex low, high;
  for (std::size_t d = 0; d < 3; ++d) {
    low[d] = header.origin_voxel[d] - 1;
    high[d] = header.origin_voxel[d] + static_cast<std::int64_t>(header.dims_voxels[d]);
  }
  const std::int64_t shift = 25'600'000;  // 1e5 m
  std::uint64_t wrong = 0;
  DenseGrid(low, high).for_each([&](const lattice::VoxelIndex& v) {
    wrong += far.map().value(v[0] + shift, v[1] - shift, v[2] + shift) !=
             near.map().value(v[0], v[1], v[2]);
  });
  EXPECT_EQ(wrong, 0u);
  // The rounding of placing it there is counted into the guarantee.
  EXPECT_GT(far.map().header().static_deviation_m, header.static_deviation_m);
}

}  // namespace
}  // namespace forcelayer

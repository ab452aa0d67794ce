// The bake against the dense reference, voxel for voxel.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <utility>

#include "tests/support/baked_scene.h"
#include "tests/support/mesh_scene.h"
#include "tests/support/reference_bake.h"
#include "tests/support/sanitized.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/soups.h"
#include "voxelize/distance/euclidean_growth.h"

namespace forcelayer {
namespace {

using reference::BakedScene;
using reference::LatticeMesh;
using reference::options_with;
using reference::Random;
using reference::real;
using reference::whole;

std::vector<lattice::VoxelIndex> voxels_of(const std::vector<mesh::Vec3d>& points_m) {
  std::vector<lattice::VoxelIndex> voxels;
  for (const mesh::Vec3d& p : points_m) {
    voxels.push_back({static_cast<std::int64_t>(std::floor(p[0])),
                      static_cast<std::int64_t>(std::floor(p[1])),
                      static_cast<std::int64_t>(std::floor(p[2]))});
  }
  return voxels;
}

// The progress goes on while nodes are built, and weighs objects by their work.
TEST(Bake, TellsItsProgressThroughout) {
  Random random(7);
  reference::MeshScene scene;
  for (const double extent : {300.0, 8.0, 8.0, 8.0}) {
    scene.meshes.push_back(reference::random_object(random, {0, 0, 0}, extent));
  }
  for (const Metric metric : {Metric::kEuclidean, Metric::kChebyshev}) {
    voxelize::BakeOptions options = options_with(2, 1, metric);
    std::vector<std::pair<std::string, double>> told;
    options.progress = [&](const char* stage, double done) { told.emplace_back(stage, done); };
    std::vector<voxelize::SceneObject> objects = scene.objects();
    objects[0].work = 1e6;
    ASSERT_TRUE(voxelize::bake(objects, options));
    ASSERT_GT(told.size(), 20u);
    double last = 0, last_small = 0, widest = 0;
    for (const auto& [stage, done] : told) {
      EXPECT_GE(done, last) << stage;
      if (stage == "voxels" && done < 0.1)
        last_small = done;
      else if (stage != "voxels")
        widest = std::max(widest, done - last);
      last = done;
    }
    EXPECT_EQ(last, 1);
    EXPECT_LT(last_small, 1e-5) << "three small objects of four";
    // Nodes are shared, and the file is written, in silence.
    EXPECT_LT(widest, 0.25);
  }
}

TEST(Bake, EqualsTheReferenceOnRandomScenes) {
  for (std::uint64_t seed = 1; seed <= 160; seed += test::seed_step(5)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, seed % 4 == 0 ? 70 : 24, 4);
    const auto layers = static_cast<std::uint32_t>(whole(random, 0, 3));
    const auto expected = reference::offset_scene(
        reference::united_scene(scene.lattice(), {}, layers + 2), static_cast<int>(layers));
    const BakedScene baked(scene.objects(), options_with(layers));
    reference::expect_equal(baked.map(), expected);
    if (HasFatalFailure()) return;
  }
}

TEST(Bake, EqualsTheReferenceWithManyLayers) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, 12, 4);
    const auto layers = static_cast<std::uint32_t>(whole(random, 4, distance::kMaxBakedLayers));
    const auto expected = reference::offset_scene(
        reference::united_scene(scene.lattice(), {}, layers + 2), static_cast<int>(layers));
    const BakedScene baked(scene.objects(), options_with(layers));
    reference::expect_equal(baked.map(), expected);
    if (HasFatalFailure()) return;
  }
}

TEST(Bake, ClearanceIsExactOnEveryLevel) {
  for (std::uint64_t seed = 1; seed <= 25; seed += test::seed_step(7)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    reference::MeshScene scene = reference::random_scene(random, seed % 2 == 0 ? 4 : 16, 4);
    if (seed % 3 == 0) {  // two small things far apart, for distances across nodes and blocks
      mesh::Mesh far = scene.meshes.front();
      mesh::Vec3d step;
      for (double& x : step) x = static_cast<double>(whole(random, -2, 2) * whole(random, 0, 700));
      for (mesh::Vec3d& vertex : far.vertices) {
        for (std::size_t d = 0; d < 3; ++d) vertex[d] += step[d];
      }
      scene.meshes = {scene.meshes.front(), far};
    }
    std::vector<LatticeMesh> meshes = scene.lattice();
    const BakedScene baked(scene.objects(), options_with(1));
    std::vector<lattice::VoxelIndex> held;  // object by object: the grid around both would be large
    for (const LatticeMesh& mesh : meshes) {
      const auto values = reference::offset_scene(reference::united_scene({mesh}, {}, 3), 1);
      values.for_each([&](const lattice::VoxelIndex& v) {
        if (values.at(v) != 0) held.push_back(v);
      });
    }
    reference::expect_exact_clearance(baked.map(), held);
    if (HasFatalFailure()) return;
  }
}

TEST(Bake, FreeSeedsOpenWhatEnclosesThem) {
  int opened = 0, scenes = 0;
  for (std::uint64_t seed = 1; seed <= 60; seed += test::seed_step(7)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    ++scenes;
    reference::MeshScene scene = reference::random_scene(random, 30, 4);
    const auto without = reference::united_scene(scene.lattice(), {}, 4);
    // Seeds anywhere in the box but in the surface of an object.
    for (int attempt = 0; attempt < 40 && scene.seeds_m.size() < 3; ++attempt) {
      lattice::VoxelIndex voxel;
      for (std::size_t d = 0; d < 3; ++d) {
        voxel[d] = whole(random, without.geometry.low()[d], without.geometry.high()[d]);
      }
      if (without.geometry.at(voxel) == 1) continue;
      if (attempt < 30 && without.interior.at(voxel) == 0) continue;
      opened += without.interior.at(voxel);
      scene.seeds_m.push_back({static_cast<double>(voxel[0]) + 0.5,
                               static_cast<double>(voxel[1]) + 0.25,
                               static_cast<double>(voxel[2])});
    }
    const auto expected = reference::offset_scene(
        reference::united_scene(scene.lattice(), voxels_of(scene.seeds_m), 4), 2);
    voxelize::BakeOptions options = options_with(2);
    options.free_seeds_m = scene.seeds_m;
    reference::expect_equal(BakedScene(scene.objects(), options).map(), expected);
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(opened, scenes / 2) << "the test has lost its seeds inside solids";
}

// Merging by precedence: interior > surface > proximity > free.
std::uint8_t merged(std::uint8_t a, std::uint8_t b) {
  constexpr int kRank[4] = {0, 3, 2, 1};
  return kRank[a] > kRank[b] ? a : b;
}

TEST(Bake, OffsettingEachObjectAndMergingGivesTheSame) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, 20, 4);
    const int layers = static_cast<int>(whole(random, 0, 3));
    const auto meshes = scene.lattice();
    reference::DenseGrid all = reference::grid_around(meshes, layers + 2);
    for (const LatticeMesh& mesh : meshes) {
      reference::ReferenceScene object{reference::grid_around(meshes, layers + 2),
                                       reference::grid_around(meshes, layers + 2)};
      reference::DenseGrid marks = reference::grid_around(meshes, layers + 2);
      reference::mark_geometry(mesh, marks);
      reference::mark_free({}, marks);
      marks.for_each([&](const lattice::VoxelIndex& v) {
        object.geometry.at(v) = marks.at(v) == 1;
        object.interior.at(v) = marks.at(v) == 0;
      });
      const auto values = reference::offset_scene(object, layers);
      values.for_each(
          [&](const lattice::VoxelIndex& v) { all.at(v) = merged(all.at(v), values.at(v)); });
    }
    const BakedScene baked(scene.objects(), options_with(static_cast<std::uint32_t>(layers)));
    reference::expect_equal(baked.map(), all);
    if (HasFatalFailure()) return;
  }
}

// Solids whose inside holds whole nodes and blocks without surface.
TEST(Bake, DeepInteriorAndEnclosedFreeSpaceAreRight) {
  reference::MeshScene scene;
  mesh::Mesh& mesh = scene.meshes.emplace_back();
  constexpr double kLow = -777, kHigh = 901;  // 1679 voxels: a block of 512 lies inside
  reference::add_box(mesh, {kLow, kLow, kLow}, {kHigh + 0.5, kHigh + 0.5, kHigh + 0.5});
  const auto expect_inside = [&](const Voxmap& map, VoxelValue inside, int layers) {
    Random random(7);
    for (int n = 0; n < 200000; ++n) {
      lattice::VoxelIndex v;
      std::int64_t outside = INT64_MIN;  // Chebyshev distance beyond the box, negative inside
      for (std::size_t d = 0; d < 3; ++d) {
        v[d] = n % 2 == 0 ? whole(random, -800, 920)
                          : whole(random, 0, 1) * 1678 - 777 + whole(random, -6, 6);
        outside = std::max({outside, -777 - v[d], v[d] - 901});
      }
      VoxelValue expected = VoxelValue::kFree;
      const std::int64_t c = std::abs(outside);
      if (outside < 0 && c > layers + 1) expected = inside;
      if (c == layers + 1)
        expected = outside < 0 && inside == VoxelValue::kInterior ? inside : VoxelValue::kProximity;
      if (c == layers)
        expected = outside < 0 && inside == VoxelValue::kInterior ? inside : VoxelValue::kSurface;
      if (c < layers) expected = VoxelValue::kInterior;
      ASSERT_EQ(map.value(v[0], v[1], v[2]), expected) << v[0] << ' ' << v[1] << ' ' << v[2];
    }
  };
  const BakedScene solid(scene.objects(), options_with(2));
  expect_inside(solid.map(), VoxelValue::kInterior, 2);
  const std::uint64_t side = 1679 + 2 * 1;  // the box and what lies at most k-1 outside
  EXPECT_EQ(solid.map().header().interior_voxels, side * side * side);

  voxelize::BakeOptions options = options_with(2);
  options.free_seeds_m = {{10, -20, 30}};
  expect_inside(BakedScene(scene.objects(), options).map(), VoxelValue::kFree, 2);
}

TEST(Bake, SameBytesForAnyNumberOfThreadsAndOrderOfObjectsAndTriangles) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    reference::MeshScene scene = reference::random_scene(random, 200, 4);
    voxelize::BakeOptions options = options_with(2);
    options.threads = 1;
    const std::string expected = BakedScene(scene.objects(), options).bytes();
    for (const int threads : {2, 4, 16}) {
      options.threads = threads;
      ASSERT_EQ(BakedScene(scene.objects(), options).bytes(), expected) << threads << " threads";
    }
    std::shuffle(scene.meshes.begin(), scene.meshes.end(), random);
    for (mesh::Mesh& mesh : scene.meshes) {
      std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
      for (mesh::Triangle& triangle : mesh.triangles) {
        std::rotate(triangle.begin(), triangle.begin() + whole(random, 0, 2), triangle.end());
        if (whole(random, 0, 1) == 0) std::swap(triangle[0], triangle[1]);
      }
    }
    ASSERT_EQ(BakedScene(scene.objects(), options).bytes(), expected) << "shuffled";
    // Duplicated triangles change the number of triangles and nothing else.
    for (mesh::Mesh& mesh : scene.meshes) {
      const auto triangles = mesh.triangles;
      mesh.triangles.insert(mesh.triangles.end(), triangles.begin(), triangles.end());
    }
    auto doubled = voxelize::bake(scene.objects(), options);
    ASSERT_TRUE(doubled);
    doubled->header.triangles /= 2;
    test::ScratchFolder folder;
    ASSERT_TRUE(write_voxmap(folder / "doubled.vox", doubled->content("{}")));
    std::ifstream file(folder / "doubled.vox", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    ASSERT_EQ(bytes, expected) << "duplicated triangles";
  }
}

// Triangles in memory, and in a temporary file: then each mesh is read when it is needed, and let
// go.
TEST(Bake, SameBytesWithTrianglesOnDisk) {
  for (std::uint64_t seed = 1; seed <= 24; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, 100, 4);
    voxelize::BakeOptions options =
        options_with(2, 1, seed % 3 == 0 ? Metric::kChebyshev : Metric::kEuclidean);
    options.distances = seed % 3 == 1;
    options.find_narrow_passages = seed % 2 == 0;
    if (seed % 5 == 0) options.roi_m = {-1500, -1500, -1500, 1500, 30, 1500};
    const auto expected = voxelize::bake(scene.objects(), options);

    std::vector<voxelize::SceneObject> objects = scene.objects();
    std::size_t alive = 0;
    for (voxelize::SceneObject& object : objects) {
      const mesh::Mesh* const mesh = std::exchange(object.mesh, nullptr);
      object.triangle_count = mesh->triangles.size();
      object.read_mesh = [&alive, mesh]() -> Result<std::shared_ptr<const mesh::Mesh>> {
        ++alive;
        return std::shared_ptr<const mesh::Mesh>(new mesh::Mesh(*mesh), [&](mesh::Mesh* copy) {
          --alive;
          delete copy;
        });
      };
    }
    options.max_triangle_bytes = 0;
    std::size_t max_alive = 0;
    options.progress = [&](const char*, double) { max_alive = std::max(max_alive, alive); };
    const auto baked = voxelize::bake(objects, options);
    ASSERT_EQ(bool(baked), bool(expected));
    if (!baked) continue;  // a region with nothing in it
    EXPECT_EQ(voxmap_bytes(baked->content("{}")), voxmap_bytes(expected->content("{}")));
    EXPECT_GT(baked->bytes_on_disk, 0u);
    EXPECT_EQ(expected->bytes_on_disk, 0u);
    // One object for each of two threads.
    EXPECT_LE(max_alive, 2u);
    EXPECT_EQ(alive, 0u);
  }
}

}  // namespace
}  // namespace forcelayer

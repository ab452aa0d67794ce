// A bake through a cache gives the bytes of a bake without one, whatever the cache holds.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/support/baked_scene.h"
#include "tests/support/scratch_folder.h"
#include "tests/support/soups.h"
#include "voxelize/cache/cache_folder.h"

namespace forcelayer {
namespace {

namespace fs = std::filesystem;
using reference::Random;
using reference::real;
using reference::whole;

cache::Digest digest_of_mesh(const mesh::Mesh& mesh) {
  return cache::DigestBuilder()
      .bytes(std::as_bytes(std::span(mesh.vertices)))
      .bytes(std::as_bytes(std::span(mesh.triangles)))
      .finish();
}

struct CachedScene {
  std::vector<mesh::Mesh> meshes;
  std::vector<mesh::Vec3d> positions;

  std::vector<voxelize::SceneObject> objects() const {
    std::vector<voxelize::SceneObject> list;
    for (std::size_t i = 0; i < meshes.size(); ++i) {
      voxelize::SceneObject& object = list.emplace_back();
      object.name = "object";
      object.mesh = &meshes[i];
      object.world_from_mesh.translation = positions[i];
      object.mesh_digest = digest_of_mesh(meshes[i]);
    }
    return list;
  }
};

CachedScene random_scene(Random& random) {
  CachedScene scene;
  const double extent = real(random, 20, 150);
  for (std::int64_t n = whole(random, 2, 6); n > 0; --n) {
    scene.meshes.push_back(reference::random_object(random, {0, 0, 0}, real(random, 5, extent)));
    mesh::Vec3d at;
    for (double& x : at) x = real(random, -200, 200);
    scene.positions.push_back(at);
  }
  return scene;
}

std::string bytes_of(const voxelize::Bake& bake) {
  const auto bytes = voxmap_bytes(bake.content("{}"));
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

voxelize::Bake baked(const CachedScene& scene, const voxelize::BakeOptions& options) {
  auto result = bake(scene.objects(), options);
  if (!result) throw std::runtime_error(to_line(result.error()));
  return std::move(*result);
}

std::size_t found(const voxelize::Bake& bake) {
  return static_cast<std::size_t>(
      std::count_if(bake.objects.begin(), bake.objects.end(),
                    [](const voxelize::ObjectReport& object) { return object.from_cache; }));
}

class BakeCacheTest : public ::testing::Test {
 protected:
  BakeCacheTest() {
    auto cache = cache::CacheFolder::open((scratch_ / "cache").string());
    if (!cache) throw std::runtime_error(to_line(cache.error()));
    cache_.emplace(std::move(*cache));
    plain_.voxel_size_m = 1;
    plain_.threads = 2;
    cached_ = plain_;
    cached_.cache = &*cache_;
    cached_.scene_name = "scene";
  }

  void use(std::uint32_t layers, Metric metric) {
    plain_.layers = cached_.layers = layers;
    plain_.metric = cached_.metric = metric;
  }

  test::ScratchFolder scratch_;
  std::optional<cache::CacheFolder> cache_;
  voxelize::BakeOptions plain_, cached_;
};

TEST_F(BakeCacheTest, SameBytesColdWarmAndAfterEveryChange) {
  std::size_t reused = 0, rebuilt = 0, distances_reused = 0, measured = 0;
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    CachedScene scene = random_scene(random);
    const bool euclidean = seed % 3 == 0;
    use(static_cast<std::uint32_t>(whole(random, euclidean ? 1 : 0, 4)),
        euclidean ? Metric::kEuclidean : Metric::kChebyshev);
    ASSERT_EQ(bytes_of(baked(scene, cached_)), bytes_of(baked(scene, plain_))) << "cold";
    const voxelize::Bake warm = baked(scene, cached_);
    ASSERT_EQ(bytes_of(warm), bytes_of(baked(scene, plain_))) << "warm";
    ASSERT_EQ(found(warm), scene.meshes.size());
    ASSERT_EQ(warm.reused_nodes, warm.nodes);
    ASSERT_EQ(warm.reused_distance_nodes, warm.distance_nodes);
    ASSERT_EQ(warm.distance_nodes > 0, euclidean);

    for (int change = 0; change < 4; ++change) {
      const auto i = static_cast<std::size_t>(
          whole(random, 0, static_cast<std::int64_t>(scene.meshes.size()) - 1));
      if (change == 3) {
        scene.meshes.erase(scene.meshes.begin() + static_cast<std::ptrdiff_t>(i));
        scene.positions.erase(scene.positions.begin() + static_cast<std::ptrdiff_t>(i));
      } else if (change == 2) {  // all of it, by whole nodes: they look the same elsewhere
        for (mesh::Vec3d& at : scene.positions)
          at[0] += 64 * static_cast<double>(whole(random, -9, 9));
      } else {
        scene.positions[i][static_cast<std::size_t>(change)] += real(random, -30, 30);
      }
      const voxelize::Bake result = baked(scene, cached_);
      ASSERT_EQ(bytes_of(result), bytes_of(baked(scene, plain_))) << "change " << change;
      reused += result.reused_nodes;
      rebuilt += result.nodes - result.reused_nodes;
      distances_reused += result.reused_distance_nodes;
      measured += result.distance_nodes - result.reused_distance_nodes;
      if (change < 2) {
        ASSERT_EQ(found(result), scene.meshes.size() - 1);
      }
    }
  }
  EXPECT_GT(reused, rebuilt / 4) << "hardly any node is found again";
  EXPECT_GT(rebuilt, 0u);
  EXPECT_GT(distances_reused, measured / 4) << "hardly any distance is found again";
  EXPECT_GT(measured, 0u);
}

// Objects have other numbers once one before them is gone: in bricks that several share, and in
// boxes of one. Distances of an object that looks the same in voxels, but is another, are measured.
TEST_F(BakeCacheTest, DistancesAreFoundUnderTheNumbersOfTheNextBake) {
  use(2, Metric::kEuclidean);
  CachedScene scene;
  for (const double x : {0.0, 300.0, 321.5, 600.0}) {
    reference::add_box(scene.meshes.emplace_back(), {0, 0, 0}, {20, 20, 20});
    scene.positions.push_back({x, 0, 0});
  }
  baked(scene, cached_);
  const auto remove = [&](std::ptrdiff_t n) {
    scene.meshes.erase(scene.meshes.begin() + n);
    scene.positions.erase(scene.positions.begin() + n);
  };
  remove(0);
  const voxelize::Bake fewer = baked(scene, cached_);
  EXPECT_EQ(bytes_of(fewer), bytes_of(baked(scene, plain_)));
  EXPECT_EQ(fewer.reused_distance_nodes, fewer.distance_nodes);
  scene.positions[0][0] += 1e-3;
  const voxelize::Bake moved = baked(scene, cached_);
  EXPECT_EQ(bytes_of(moved), bytes_of(baked(scene, plain_)));
  EXPECT_GT(moved.reused_distance_nodes, 0u);
  EXPECT_LT(moved.reused_distance_nodes, moved.distance_nodes);
  cached_.range_m = plain_.range_m = 6;
  const voxelize::Bake deeper = baked(scene, cached_);
  EXPECT_EQ(bytes_of(deeper), bytes_of(baked(scene, plain_)));
  EXPECT_EQ(deeper.reused_distance_nodes, 0u);
}

// The same bake again after every kind of damage to the cache.
// Euclidean layers reach beyond an object's box, here into other directory cells.
TEST_F(BakeCacheTest, GrownObjectsAreFoundAcrossDirectoryCells) {
  CachedScene scene;
  reference::add_box(scene.meshes.emplace_back(), {0, 0, 0}, {12, 12, 12});
  scene.positions.push_back({0, 512 - 12, 0});
  for (const std::uint32_t layers : {1u, 2u, 30u}) {
    SCOPED_TRACE(layers);
    use(layers, Metric::kEuclidean);
    cached_.find_cavities = true;
    const voxelize::Bake cold = baked(scene, cached_), warm = baked(scene, cached_);
    EXPECT_EQ(found(cold), 0u);
    EXPECT_EQ(found(warm), 1u);
    EXPECT_EQ(bytes_of(cold), bytes_of(baked(scene, plain_)));
    EXPECT_EQ(bytes_of(warm), bytes_of(cold));
    EXPECT_EQ(cold.objects[0].cavities.size(), 1u);
    EXPECT_EQ(warm.objects[0].cavities.size(), 1u);
  }
}

TEST_F(BakeCacheTest, DamagedEntriesAreRebuilt) {
  Random random(99);
  const CachedScene scene = random_scene(random);
  const std::string expected = bytes_of(baked(scene, plain_));
  for (int round = 0; round < 12; ++round) {
    ASSERT_EQ(bytes_of(baked(scene, cached_)), expected) << "round " << round;
    ASSERT_EQ(found(baked(scene, cached_)), scene.meshes.size());
    for (const auto& file : fs::recursive_directory_iterator(scratch_ / "cache")) {
      if (!file.is_regular_file()) continue;
      const auto size = static_cast<std::int64_t>(file.file_size());
      if (round % 3 == 0) {
        fs::resize_file(file.path(), static_cast<std::uintmax_t>(whole(random, 0, size - 1)));
      } else if (round % 3 == 1) {
        fs::remove(file.path());
      } else {
        std::fstream bytes(file.path(), std::ios::in | std::ios::out | std::ios::binary);
        bytes.seekp(whole(random, 0, size - 1));
        bytes.put(static_cast<char>(whole(random, 0, 255)));
      }
    }
  }
}

// An object's key holds everything that its voxels depend on.
TEST_F(BakeCacheTest, EveryInputOfAnObjectMakesAnotherEntry) {
  use(2, Metric::kChebyshev);
  CachedScene scene;
  reference::add_box(scene.meshes.emplace_back(), {0, 0, 0}, {20, 20, 20});
  scene.positions.push_back({0, 0, 0});
  baked(scene, cached_);
  ASSERT_EQ(found(baked(scene, cached_)), 1u);

  const auto expect_other = [&](const char* what, const CachedScene& changed,
                                voxelize::BakeOptions options) {
    EXPECT_EQ(found(baked(changed, options)), 0u) << what;
    const std::string bytes = bytes_of(baked(changed, options));
    options.cache = nullptr;
    EXPECT_EQ(bytes, bytes_of(baked(changed, options))) << what;
  };
  CachedScene moved = scene;
  moved.positions[0][2] = 1e-9;
  expect_other("transform", moved, cached_);
  CachedScene bent = scene;
  bent.meshes[0].vertices[3][1] += 1e-9;
  expect_other("vertex", bent, cached_);
  CachedScene swapped = scene;
  std::swap(swapped.meshes[0].triangles[0][0], swapped.meshes[0].triangles[0][1]);
  expect_other("triangle", swapped, cached_);
  voxelize::BakeOptions finer = cached_;
  finer.voxel_size_m = 0.5;
  expect_other("voxel size", scene, finer);
  voxelize::BakeOptions seeded = cached_;
  seeded.free_seeds_m = {{10, 10, 10}};
  expect_other("free seed", scene, seeded);
  voxelize::BakeOptions layered = cached_;
  layered.layers = 3;  // not in an object's key
  EXPECT_EQ(found(baked(scene, layered)), 1u);
  voxelize::BakeOptions with_cavities = cached_;
  with_cavities.find_cavities = true;
  EXPECT_EQ(found(baked(scene, with_cavities)), 0u) << "the entry knows nothing about cavities";
  const voxelize::Bake again = baked(scene, with_cavities);
  EXPECT_EQ(found(again), 1u);
  ASSERT_EQ(again.objects[0].cavities.size(), 1u);
  EXPECT_EQ(again.objects[0].cavities[0].voxels, 19u * 19 * 19);
}

// The last bake needs nothing but the shards.
TEST_F(BakeCacheTest, ShardsAreFoundByTheLastBake) {
  Random random(5);
  const CachedScene scene = random_scene(random);
  const auto objects = scene.objects();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const auto shard = voxelize::bake_shard(std::span(objects).subspan(i, 1), cached_);
    ASSERT_TRUE(shard) << to_line(shard.error());
    EXPECT_EQ(shard->objects.size(), 1u);
  }
  const voxelize::Bake result = baked(scene, cached_);
  EXPECT_EQ(found(result), objects.size());
  EXPECT_EQ(bytes_of(result), bytes_of(baked(scene, plain_)));
  EXPECT_TRUE(voxelize::bake_shard({}, cached_)) << "a shard with nothing in it";
}

TEST_F(BakeCacheTest, RegionsUseTheCacheToo) {
  Random random(6);
  const CachedScene scene = random_scene(random);
  plain_.roi_m = cached_.roi_m = {-50, -50, -50, 60, 70, 80};
  ASSERT_EQ(bytes_of(baked(scene, cached_)), bytes_of(baked(scene, plain_)));
  ASSERT_EQ(bytes_of(baked(scene, cached_)), bytes_of(baked(scene, plain_)));
}

}  // namespace
}  // namespace forcelayer

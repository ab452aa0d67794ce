// Euclidean layers against the dense reference, and the exact test behind them.
#include <gtest/gtest.h>

#include "tests/support/baked_scene.h"
#include "tests/support/mesh_scene.h"
#include "tests/support/reference_distance.h"
#include "tests/support/soups.h"
#include "voxelize/distance/euclidean_growth.h"

namespace forcelayer {
namespace {

using reference::BakedScene;
using reference::LatticeMesh;
using reference::Random;
using reference::whole;

voxelize::BakeOptions euclidean_options(std::uint32_t layers) {
  return reference::options_with(layers, 1, Metric::kEuclidean);
}

// Corners on fine and on coarse lattices (so that distances tie), some of them equal, some large.
lattice::LatticeTriangle random_triangle(Random& random) {
  const std::int64_t grid = std::int64_t{1} << whole(random, 0, lattice::kSnapBits);
  // Some around the size from which wider integers are needed.
  const std::uint64_t size = random() % 8;
  const std::int64_t extent = size == 0   ? 4000
                              : size == 1 ? whole(random, 980, 1020)
                                          : whole(random, 1, 6);
  lattice::LatticeTriangle triangle;
  for (lattice::LatticePoint& corner : triangle) {
    for (std::int64_t& x : corner) {
      x = whole(random, -extent * lattice::kSnapUnits / grid, extent * lattice::kSnapUnits / grid) *
          grid;
    }
  }
  if (random() % 6 == 0) triangle[1] = triangle[0];
  if (random() % 6 == 0) {
    for (std::size_t d = 0; d < 3; ++d) triangle[2][d] = (triangle[0][d] + triangle[1][d]) / 2;
  }
  return triangle;
}

// A voxel that the triangle passes by: somewhere on it, and a few voxels off.
lattice::VoxelIndex voxel_near(Random& random, const lattice::LatticeTriangle& triangle,
                               int radius) {
  double s = reference::real(random, 0, 1), t = reference::real(random, 0, 1);
  if (s + t > 1) s = 1 - s, t = 1 - t;
  lattice::VoxelIndex voxel;
  for (std::size_t d = 0; d < 3; ++d) {
    const double at = static_cast<double>(triangle[0][d]) +
                      s * static_cast<double>(triangle[1][d] - triangle[0][d]) +
                      t * static_cast<double>(triangle[2][d] - triangle[0][d]);
    voxel[d] = (static_cast<std::int64_t>(at) >> lattice::kSnapBits) +
               whole(random, -radius - 1, radius + 1);
  }
  return voxel;
}

TEST(CenterDistance, EqualsTheNearestFeatures) {
  constexpr double kUnit = static_cast<double>(lattice::kSnapUnits);
  int near = 0, far = 0, ties = 0;
  for (std::uint64_t seed = 1; seed <= 6000; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    lattice::LatticeTriangle triangle = random_triangle(random);
    if (seed % 4 == 0) {  // square to an axis, where distances are whole numbers
      for (lattice::LatticePoint& corner : triangle)
        corner[seed / 4 % 3] = triangle[0][seed / 4 % 3];
    }
    std::int64_t radius = distance::interior_radius_units(seed % 8 == 1 ? 30 : whole(random, 1, 3));
    const lattice::VoxelIndex voxel =
        voxel_near(random, triangle, static_cast<int>(radius / lattice::kSnapUnits));
    const double distance =
        reference::point_distance(triangle, reference::center_of(voxel)) * kUnit;
    // Every other radius is the distance itself, or a unit more or less.
    if (seed % 2 == 0) {
      radius = std::max<std::int64_t>(std::llround(distance) + whole(random, -1, 1), 1);
    }
    const bool tie = std::abs(distance - static_cast<double>(radius)) < 1e-6;
    const bool expected = distance < static_cast<double>(radius) && !tie;
    ASSERT_EQ(distance::center_is_nearer(triangle, voxel, radius), expected)
        << "distance " << distance;
    ++(tie ? ties : expected ? near : far);
  }
  EXPECT_GT(near, 1000);
  EXPECT_GT(far, 1000);
  EXPECT_GT(ties, 50);
}

TEST(EuclideanBake, EqualsTheReferenceOnRandomScenes) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, seed % 5 == 0 ? 30 : 12, 3);
    const auto layers = static_cast<std::uint32_t>(seed == 1 ? 30 : whole(random, 1, 4));
    const std::vector<LatticeMesh> meshes = scene.lattice();
    const auto expected = reference::euclidean_scene(
        meshes, reference::united_scene(meshes, {}, layers + 3), static_cast<int>(layers));
    const BakedScene baked(scene.objects(), euclidean_options(layers));
    EXPECT_EQ(baked.map().header().metric, static_cast<std::uint32_t>(Metric::kEuclidean));
    EXPECT_EQ(baked.map().header().offset_layers, layers);
    reference::expect_equal(baked.map(), expected);
    if (HasFatalFailure()) return;
  }
}

// A large triangle is cut where it leaves a node's surroundings, and decided on whole.
TEST(EuclideanBake, LargeTrianglesAreExact) {
  mesh::Mesh mesh;
  reference::add_triangle(mesh, {-400.25, -300.5, 3.75}, {500.5, -200.125, 40.5},
                          {20.25, 600.75, -70.5});
  const std::vector<voxelize::SceneObject> objects{{"object", &mesh, mesh::Affine{}, {}, 0}};
  const BakedScene baked(objects, euclidean_options(3));
  const LatticeMesh lattice = reference::snapped(mesh, mesh::Affine{}, 1);
  Random random(5);
  int near = 0;
  for (int n = 0; n < 1500; ++n) {
    const lattice::VoxelIndex voxel = voxel_near(random, lattice[0], 3);
    const VoxelValue value = baked.map().value(voxel[0], voxel[1], voxel[2]);
    const bool expected = reference::is_near(lattice[0], voxel, reference::interior_radius(3));
    ASSERT_EQ(value == VoxelValue::kInterior, expected);
    near += expected;
  }
  EXPECT_GT(near, 300);
  EXPECT_LT(near, 1300);
}

// The guarantee (voxmap_format.md, section 7): no point of a voxel that is not interior is nearer
// than k - 1 voxels; and the layers are one voxel deep in all 26 directions.
TEST(EuclideanBake, KeepsTheStandoffAndWholeLayers) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, 12, 3);
    const std::vector<LatticeMesh> meshes = scene.lattice();
    const int layers = static_cast<int>(whole(random, 2, 3));
    const BakedScene baked(scene.objects(), euclidean_options(static_cast<std::uint32_t>(layers)));
    const Voxmap& map = baked.map();
    const auto grid = reference::grid_around(meshes, layers + 3);
    const auto level = [&](const lattice::VoxelIndex& v) {
      constexpr int kLevels[4] = {2, -1, 0, 1};
      return kLevels[static_cast<int>(map.value(v[0], v[1], v[2]))];
    };
    for (int n = 0; n < 2000; ++n) {
      lattice::VoxelIndex v;
      for (std::size_t d = 0; d < 3; ++d) v[d] = whole(random, grid.low()[d], grid.high()[d]);
      if (level(v) < 0) continue;
      reference::Point p = reference::center_of(v);
      for (double& x : p) x += reference::real(random, -0.5, 0.5);
      for (const LatticeMesh& mesh : meshes) {
        for (const lattice::LatticeTriangle& triangle : mesh) {
          ASSERT_GE(reference::point_distance(triangle, p), layers - 1 - 1e-9);
        }
      }
      lattice::VoxelIndex next = v;
      for (std::int64_t& x : next) x += whole(random, -1, 1);
      ASSERT_LE(std::abs(level(v) - level(next)), 1);
    }
  }
}

TEST(EuclideanBake, SameBytesForAnyNumberOfThreadsAndOrder) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Random random(seed);
    reference::MeshScene scene = reference::random_scene(random, 150, 3);
    voxelize::BakeOptions options = euclidean_options(2);
    options.objects = false;  // they are numbered in their order
    options.threads = 1;
    const std::string expected = BakedScene(scene.objects(), options).bytes();
    options.threads = 4;
    std::shuffle(scene.meshes.begin(), scene.meshes.end(), random);
    for (mesh::Mesh& mesh : scene.meshes) {
      std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
      for (mesh::Triangle& triangle : mesh.triangles) {
        std::rotate(triangle.begin(), triangle.begin() + whole(random, 0, 2), triangle.end());
      }
    }
    ASSERT_EQ(BakedScene(scene.objects(), options).bytes(), expected) << "seed " << seed;
  }
}

TEST(EuclideanBake, RefusesWhatHasNoMeaning) {
  mesh::Mesh mesh;
  reference::add_box(mesh, {0, 0, 0}, {4, 4, 4});
  const std::vector<voxelize::SceneObject> objects{{"object", &mesh, mesh::Affine{}, {}, 0}};
  const auto refused = [&](const voxelize::BakeOptions& options) {
    const auto baked = voxelize::bake(objects, options);
    return !baked && baked.error().code == ErrorCode::kUsage;
  };
  EXPECT_TRUE(refused(euclidean_options(0)));
  voxelize::BakeOptions options = euclidean_options(2);
  options.range_m = 1;
  EXPECT_TRUE(refused(options));
  options.range_m = 4;
  EXPECT_FALSE(refused(options));
  options.distances = false;
  EXPECT_TRUE(refused(options));
  options.distances = true;
  options.metric = Metric::kChebyshev;
  EXPECT_TRUE(refused(options));
}

TEST(EuclideanBake, RefusesStandoffsThatItCannotHold) {
  mesh::Mesh mesh;
  reference::add_box(mesh, {0, 0, 0}, {4, 4, 4});
  const std::vector<voxelize::SceneObject> objects{{"object", &mesh, mesh::Affine{}, {}, 0}};
  const auto refused = [&](double standoff, const auto& change) {
    voxelize::BakeOptions options = euclidean_options(0);
    options.standoff_m = standoff;
    change(options);
    const auto baked = voxelize::bake(objects, options);
    return !baked && baked.error().code == ErrorCode::kUsage;
  };
  const auto none = [](voxelize::BakeOptions&) {};
  const double smallest = 0.1 + 888.0 / 1024;
  EXPECT_FALSE(refused(smallest, none));
  EXPECT_TRUE(refused(smallest - 1e-3, none));
  EXPECT_TRUE(refused(-1, none));
  EXPECT_FALSE(refused(30, none));
  EXPECT_TRUE(refused(30.01, none));
  EXPECT_TRUE(refused(2, [](voxelize::BakeOptions& o) { o.layers = 2; }));
  EXPECT_TRUE(refused(2, [](voxelize::BakeOptions& o) { o.distances = false; }));
  EXPECT_TRUE(refused(2, [](voxelize::BakeOptions& o) { o.metric = Metric::kChebyshev; }));
  const auto covered = [](voxelize::BakeOptions& o) { o.compliance = {{1.5, 4}}; };
  EXPECT_TRUE(refused(2.3, covered));
  EXPECT_FALSE(refused(2.4, covered));
}

// Specification, section 10: n, where the depth of a compliance is a whole number of voxels and the
// quotient of the two lengths lies above it, is it, and is one more a billionth of a voxel deeper.
TEST(EuclideanBake, ForceLayersAreThoseOfTheSpecification) {
  constexpr double kVoxel = 0.005, kDepth = 0.035;
  ASSERT_GT(kDepth / kVoxel, 7);
  mesh::Mesh mesh;
  reference::add_box(mesh, {0, 0, 0}, {0.015, 0.01, 0.01});
  const std::vector<voxelize::SceneObject> objects{{"object", &mesh, mesh::Affine{}, {}, 0}};
  for (const auto& [depth_m, layers] : {std::pair{kDepth, 7}, std::pair{kDepth * (1 + 1e-8), 8}}) {
    const int n = layers;  // clang 14 lets no lambda see a structured binding
    voxelize::BakeOptions options = reference::options_with(1, kVoxel, Metric::kEuclidean);
    options.compliance = {{depth_m, 1}};
    const BakedScene baked(objects, options);
    const VoxmapHeader& h = baked.map().header();
    reference::DenseGrid grid({-14, -14, -14}, {16, 16, 16});
    const auto value_at = [&](const lattice::VoxelIndex& v) {
      return baked.map().value(v[0], v[1], v[2]);
    };
    std::vector<lattice::VoxelIndex> interior;
    grid.for_each([&](const lattice::VoxelIndex& v) {
      if (value_at(v) == VoxelValue::kInterior) interior.push_back(v);
    });
    ASSERT_EQ(interior.size(), h.interior_voxels);
    grid.for_each([&](const lattice::VoxelIndex& v) {
      std::int64_t steps = INT64_MAX;
      for (const lattice::VoxelIndex& i : interior) {
        steps = std::min(
            steps, std::max({std::abs(v[0] - i[0]), std::abs(v[1] - i[1]), std::abs(v[2] - i[2])}));
      }
      const VoxelValue expected = steps == 0       ? VoxelValue::kInterior
                                  : steps <= n     ? VoxelValue::kSurface
                                  : steps == n + 1 ? VoxelValue::kProximity
                                                   : VoxelValue::kFree;
      ASSERT_EQ(value_at(v), expected) << v[0] << ' ' << v[1] << ' ' << v[2];
    });
  }
}

}  // namespace
}  // namespace forcelayer

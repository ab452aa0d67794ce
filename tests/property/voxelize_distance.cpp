// Voxels of 4 and 8 bits: every stored distance against the dense reference, the values that are
// read from it, and what the force field relies on.
#include <gtest/gtest.h>

#include "tests/support/baked_scene.h"
#include "tests/support/every_target.h"
#include "tests/support/mesh_scene.h"
#include "tests/support/reference_distance.h"
#include "tests/support/soups.h"

namespace forcelayer {
namespace {

using reference::BakedScene;
using reference::LatticeMesh;
using reference::Point;
using reference::Random;
using reference::whole;

constexpr double kTolerance = 2e-4;  // of single precision, in voxels

voxelize::BakeOptions distance_options(std::uint32_t layers, std::uint32_t bits,
                                       double range_voxels = 0) {
  voxelize::BakeOptions options = reference::options_with(layers, 1, Metric::kEuclidean);
  options.bits = bits;
  options.range_m = range_voxels;
  return options;
}

// The definition of voxmap_format.md, section 6, in doubles.
class Definition {
 public:
  explicit Definition(const VoxmapHeader& header, double layer_voxels = 1) : h_(header) {
    interior_ = h_.offset_layers - 1 + std::sqrt(3.0) / 2 + 1e-3;
    zero_ = interior_ + layer_voxels;
    surface_ = zero_ + (3 + 3 * std::sqrt(2.0) + std::sqrt(3.0)) / 8 + quantum();
    proximity_ = surface_ + std::sqrt(3.0);
  }
  double quantum() const { return h_.quantum_m / h_.voxel_size_m; }
  double zero() const { return zero_; }

  std::uint32_t code(double distance) const {
    const double steps = (distance - zero_) / quantum() + h_.zero_code;
    const auto nearest = static_cast<std::int64_t>(std::llround(std::max(steps, 0.0)));
    const auto between = [&](std::uint32_t low, std::uint32_t high) {
      return static_cast<std::uint32_t>(
          std::clamp<std::int64_t>(nearest, std::int64_t{low}, std::int64_t{high}));
    };
    if (distance < interior_) return between(0, h_.surface_code - 1);
    if (distance < surface_) return between(h_.surface_code, h_.proximity_code - 1);
    if (distance < proximity_) return between(h_.proximity_code, h_.free_code - 1);
    return h_.free_code;
  }

 private:
  const VoxmapHeader& h_;
  double interior_, zero_, surface_, proximity_;
};

std::uint32_t code_at(const Voxmap& map, const lattice::VoxelIndex& v) {
  std::array<std::int32_t, 3> at;
  for (std::size_t d = 0; d < 3; ++d) {
    at[d] = static_cast<std::int32_t>(v[d] - map.view().directory_origin[d]);
  }
  if (!map.view().contains(at[0], at[1], at[2])) return map.header().free_code;
  return map.view().lookup(at[0], at[1], at[2]).code;
}

double distance_from(const std::vector<LatticeMesh>& meshes, const Point& p) {
  double least = 1e300;
  for (const LatticeMesh& mesh : meshes) {
    for (const lattice::LatticeTriangle& triangle : mesh) {
      least = std::min(least, reference::point_distance(triangle, p));
    }
  }
  return least;
}

TEST(DistanceBake, EqualsTheReferenceOnRandomScenes) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, seed % 4 == 0 ? 30 : 12, 3);
    const auto layers = static_cast<std::uint32_t>(whole(random, 1, 3));
    const std::uint32_t bits = random() % 2 ? 8 : 4;
    const double range = random() % 2 ? 0 : reference::real(random, 2, 9);
    const std::vector<LatticeMesh> meshes = scene.lattice();
    const int margin = static_cast<int>(layers) + 9;
    const auto sets = reference::united_scene(meshes, {}, margin);
    voxelize::BakeOptions options = distance_options(layers, bits, range);
    // Every third scene has a soft covering, some thinner than a voxel.
    const double covering = seed % 3 == 0 ? reference::real(random, 0.5, 3) : 0;
    if (covering > 0) {
      options.compliance = {{covering / 3, 0.5}, {covering, 4}};
      if (range > 0) options.range_m = std::max(range, covering + 1);
    }
    const double layer = std::max(1.0, covering);
    const BakedScene baked(scene.objects(), options);
    const VoxmapHeader& header = baked.map().header();
    ASSERT_EQ(header.bits_per_voxel, bits);
    ASSERT_GE(header.zero_code * header.quantum_m, header.range_m * (1 - 1e-9));
    ASSERT_EQ(header.surface_code,
              header.zero_code - std::lround(layer * header.voxel_size_m / header.quantum_m));
    ASSERT_EQ(baked.map().compliance().empty(), covering == 0);
    const Definition definition(header, layer);
    std::array<std::uint64_t, 4> counts{};
    sets.geometry.for_each([&](const lattice::VoxelIndex& v) {
      const std::uint32_t found = code_at(baked.map(), v);
      ++counts[static_cast<std::size_t>(voxel_value(header, found))];
      if (HasFatalFailure()) return;
      const double distance = distance_from(meshes, reference::center_of(v));
      const auto is_code_of = [&](double signed_distance) {
        const std::uint32_t low = definition.code(signed_distance - kTolerance);
        return low <= found && found <= definition.code(signed_distance + kTolerance);
      };
      // The side of a surface voxel's center has a test of its own.
      const bool inside = sets.interior.at(v) == 1, surface = sets.geometry.at(v) == 1;
      ASSERT_TRUE(is_code_of(inside ? -distance : distance) ||
                  (surface && !inside && is_code_of(-distance)))
          << "code " << found << " at distance " << distance << (inside ? ", inside" : "");
    });
    if (HasFatalFailure()) return;
    EXPECT_EQ(header.interior_voxels, counts[1]);
    EXPECT_EQ(header.surface_voxels, counts[2]);
    EXPECT_EQ(header.proximity_voxels, counts[3]);
  }
}

// The guarantee of section 7, and whole layers around what is free.
TEST(DistanceBake, KeepsTheStandoffAndWholeLayers) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, 12, 3);
    const std::vector<LatticeMesh> meshes = scene.lattice();
    const auto layers = static_cast<std::uint32_t>(whole(random, 2, 3));
    const BakedScene baked(scene.objects(), distance_options(layers, random() % 2 ? 8 : 4));
    const auto grid = reference::grid_around(meshes, layers + 5);
    for (int n = 0; n < 3000; ++n) {
      lattice::VoxelIndex v;
      for (std::size_t d = 0; d < 3; ++d) v[d] = whole(random, grid.low()[d], grid.high()[d]);
      const VoxelValue value = baked.map().value(v[0], v[1], v[2]);
      if (value == VoxelValue::kInterior) continue;
      Point p = reference::center_of(v);
      for (double& x : p) x += reference::real(random, -0.5, 0.5);
      ASSERT_GE(distance_from(meshes, p), layers - 1.0);
      if (value != VoxelValue::kFree) continue;
      lattice::VoxelIndex next = v;
      for (std::int64_t& x : next) x += whole(random, -1, 1);
      const VoxelValue beside = baked.map().value(next[0], next[1], next[2]);
      ASSERT_TRUE(beside == VoxelValue::kFree || beside == VoxelValue::kProximity);
    }
  }
}

// What is read trilinearly is negative only in values 1 and 2, whatever the scene.
TEST(DistanceBake, TheZeroForceLiesInTheForceLayer) {
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, 10, 3);
    const BakedScene baked(scene.objects(), distance_options(2, random() % 2 ? 8 : 4));
    const VoxmapHeader& header = baked.map().header();
    const auto grid = reference::grid_around(scene.lattice(), 8);
    int near = 0;
    for (int n = 0; n < 20000; ++n) {
      lattice::VoxelIndex v;
      for (std::size_t d = 0; d < 3; ++d) v[d] = whole(random, grid.low()[d], grid.high()[d]);
      if (baked.map().value(v[0], v[1], v[2]) != VoxelValue::kProximity) continue;
      ++near;
      // Anywhere in the voxel; often in its corners, where it is nearest to others.
      double code = 0;
      std::array<double, 3> f;
      for (double& x : f) x = random() % 2 ? reference::real(random, 0, 0.5) : 0.5;
      lattice::VoxelIndex side;
      for (std::int64_t& x : side) x = random() % 2 ? 1 : -1;
      for (unsigned c = 0; c < 8; ++c) {
        lattice::VoxelIndex at = v;
        double weight = 1;
        for (std::size_t d = 0; d < 3; ++d) {
          const bool other = (c >> d & 1) != 0;
          weight *= other ? f[d] : 1 - f[d];
          if (other) at[d] += side[d];
        }
        code += weight * code_at(baked.map(), at);
      }
      ASSERT_GE(code, header.zero_code);
    }
    EXPECT_GT(near, 100);
  }
}

// Where the surface's voxels lie between inside and outside, distances go on through it evenly, so
// that every depth has a way out.
TEST(DistanceBake, DistancesGoThroughTheSurfaceEvenly) {
  Random random(3);
  mesh::Mesh mesh;
  reference::add_sphere(mesh, {0.3, 0.6, 0.1}, 14, 48);
  const std::vector<voxelize::SceneObject> objects{{"object", &mesh, mesh::Affine{}, {}, 0}};
  const BakedScene baked(objects, distance_options(2, 8, 10));
  const VoxmapHeader& header = baked.map().header();
  const Definition definition(header);
  for (int n = 0; n < 4000; ++n) {
    lattice::VoxelIndex v;
    for (std::size_t d = 0; d < 3; ++d) v[d] = whole(random, -22, 22);
    const Point p = reference::center_of(v);
    const double distance = std::hypot(p[0] - 0.3, p[1] - 0.6, p[2] - 0.1) - 14;
    const std::uint32_t code = code_at(baked.map(), v);
    const double expected = (distance - definition.zero()) / definition.quantum();
    if (code == 0 || code >= header.free_code) continue;
    // The mesh lies up to 0.04 voxels inside the sphere.
    ASSERT_NEAR(static_cast<double>(code) - header.zero_code, expected,
                1.1 + 0.05 / definition.quantum());
  }
}

TEST(DistanceBake, SameBytesForAnyNumberOfThreadsOrderAndWholeVoxelShift) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    reference::MeshScene scene = reference::random_scene(random, 100, 3);
    voxelize::BakeOptions options = distance_options(2, 8);
    options.threads = 1;
    const BakedScene first(scene.objects(), options);
    options.threads = 4;
    std::shuffle(scene.meshes.begin(), scene.meshes.end(), random);
    for (mesh::Mesh& mesh : scene.meshes) {
      std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
      for (mesh::Triangle& triangle : mesh.triangles) {
        std::rotate(triangle.begin(), triangle.begin() + whole(random, 0, 2), triangle.end());
        if (random() % 2) std::swap(triangle[0], triangle[1]);
      }
    }
    ASSERT_EQ(BakedScene(scene.objects(), options).bytes(), first.bytes());
    const lattice::VoxelIndex by{whole(random, -90, 90), whole(random, -90, 90),
                                 whole(random, -90, 90)};
    for (mesh::Mesh& mesh : scene.meshes) {
      for (mesh::Vec3d& vertex : mesh.vertices) {
        for (std::size_t d = 0; d < 3; ++d) vertex[d] += static_cast<double>(by[d]);
      }
    }
    const BakedScene moved(scene.objects(), options);
    const VoxmapHeader& header = first.map().header();
    for (int n = 0; n < 20000; ++n) {
      lattice::VoxelIndex v, w;
      for (std::size_t d = 0; d < 3; ++d) {
        v[d] = header.origin_voxel[d] +
               whole(random, 0, static_cast<std::int64_t>(header.dims_voxels[d]) - 1);
        w[d] = v[d] + by[d];
      }
      ASSERT_EQ(code_at(first.map(), v), code_at(moved.map(), w));
    }
  }
}

// Every width of vectors that this machine has gives the same bytes, of Euclidean layers too.
class DistanceBakeOnEveryTarget : public test::EveryTarget {
 protected:
  static std::string bytes(std::uint32_t bits) {
    Random random(21);
    const reference::MeshScene scene = reference::random_scene(random, 60, 3);
    return BakedScene(scene.objects(), distance_options(2, bits)).bytes();
  }
};
INSTANTIATE_TEST_SUITE_P(Targets, DistanceBakeOnEveryTarget,
                         ::testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return hwy::TargetName(target.param); });

TEST_P(DistanceBakeOnEveryTarget, GivesTheSameBytes) {
  for (const std::uint32_t bits : {2u, 4u, 8u}) {
    const std::string here = bytes(bits);
    use(0);
    EXPECT_EQ(bytes(bits), here) << bits << " bits";
    use(GetParam());
  }
}

TEST(DistanceBake, ARegionHasTheVoxelsOfTheWhole) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, 24, 3);
    voxelize::BakeOptions options = distance_options(2, random() % 2 ? 8 : 4);
    const BakedScene all(scene.objects(), options);
    const VoxmapHeader& header = all.map().header();
    lattice::VoxelIndex low, high;
    options.roi_m.emplace();
    for (std::size_t d = 0; d < 3; ++d) {
      const auto dim = static_cast<std::int64_t>(header.dims_voxels[d]);
      low[d] = header.origin_voxel[d] + whole(random, -2, dim / 2);
      high[d] = low[d] + whole(random, 1, dim);
      (*options.roi_m)[d] = static_cast<double>(low[d]);
      (*options.roi_m)[d + 3] = static_cast<double>(high[d]);
    }
    const BakedScene part(scene.objects(), options);
    reference::DenseGrid({low[0] - 3, low[1] - 3, low[2] - 3},
                         {high[0] + 3, high[1] + 3, high[2] + 3})
        .for_each([&](const lattice::VoxelIndex& v) {
          bool inside = true;
          for (std::size_t d = 0; d < 3; ++d) inside &= v[d] >= low[d] && v[d] < high[d];
          if (HasFatalFailure()) return;
          ASSERT_EQ(code_at(part.map(), v), inside ? code_at(all.map(), v) : header.free_code);
        });
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace forcelayer

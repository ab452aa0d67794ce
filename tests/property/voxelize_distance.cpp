// Stored distances: every code and the layers beside it against the dense reference, and the bounds
// that the force field and the proofs rely on.
#include <gtest/gtest.h>

#include <functional>

#include "formats/audit/voxmap_audit.h"
#include "tests/support/baked_scene.h"
#include "tests/support/every_target.h"
#include "tests/support/mesh_scene.h"
#include "tests/support/reference_distance.h"
#include "tests/support/sanitized.h"
#include "tests/support/soups.h"

namespace forcelayer {
namespace {

using reference::BakedScene;
using reference::LatticeMesh;
using reference::Point;
using reference::Random;
using reference::whole;

constexpr double kTolerance = 2e-4;  // of single precision, in voxels

voxelize::BakeOptions distance_options(std::uint32_t layers, double range_voxels = 0) {
  voxelize::BakeOptions options = reference::options_with(layers, 1, Metric::kEuclidean);
  options.range_m = range_voxels;
  return options;
}

// The code of a distance in voxels of 1 m, rounded down (voxmap_format.md, section 6).
std::int64_t code_of(const VoxmapHeader& header, double distance) {
  const double steps = std::floor(distance / header.distance_quantum_m) + header.distance_zero_code;
  return static_cast<std::int64_t>(std::clamp(steps, 0.0, 255.0));
}

std::int64_t code_at(const Voxmap& map, const lattice::VoxelIndex& v) {
  std::array<std::int32_t, 3> at;
  for (std::size_t d = 0; d < 3; ++d) {
    at[d] = static_cast<std::int32_t>(v[d] - map.view().directory_origin[d]);
  }
  if (!map.distances()->contains(at[0], at[1], at[2])) return kMaxDistanceCode;
  return map.distances()->lookup(at[0], at[1], at[2]).code;
}

double distance_from(const std::vector<LatticeMesh>& meshes, const Point& p) {
  double smallest = 1e300;
  for (const LatticeMesh& mesh : meshes) {
    for (const lattice::LatticeTriangle& triangle : mesh) {
      smallest = std::min(smallest, reference::point_distance(triangle, p));
    }
  }
  return smallest;
}

// The layers of voxmap_format.md, section 5, by definition: the interior, and `n` times its
// neighbors and theirs.
class Layers {
 public:
  Layers(const reference::DenseGrid& inside, const reference::DenseGrid& grid, int n,
         const std::function<double(const lattice::VoxelIndex&)>& distance, double radius)
      : steps_(grid.low(), grid.high()), n_(n) {
    std::vector<lattice::VoxelIndex> edge;
    grid.for_each([&](const lattice::VoxelIndex& v) {
      if (inside.at(v) != 1 && !(distance(v) < radius)) return;
      steps_.at(v) = 1;
      edge.push_back(v);
    });
    for (int step = 2; step <= n + 2; ++step) {
      std::vector<lattice::VoxelIndex> next;
      for (const lattice::VoxelIndex& v : edge) {
        for (int i = 0; i < 27; ++i) {
          const lattice::VoxelIndex w{v[0] + i / 9 - 1, v[1] + i / 3 % 3 - 1, v[2] + i % 3 - 1};
          if (!steps_.contains(w) || steps_.at(w) != 0) continue;
          steps_.at(w) = static_cast<std::uint8_t>(step);
          next.push_back(w);
        }
      }
      edge = std::move(next);
    }
  }

  VoxelValue at(const lattice::VoxelIndex& v) const {
    const int step = steps_.at(v);
    if (step == 0) return VoxelValue::kFree;
    if (step == 1) return VoxelValue::kInterior;
    return step <= n_ + 1 ? VoxelValue::kSurface : VoxelValue::kProximity;
  }

 private:
  reference::DenseGrid steps_;  // from the interior, which has 1
  int n_;
};

// Scenes with layers; every other one has a standoff in their place.
TEST(DistanceBake, EqualsTheReferenceOnRandomScenes) {
  for (std::uint64_t seed = 1; seed <= 24; seed += test::seed_step(5)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, seed % 4 == 0 ? 30 : 12, 3);
    const auto layers = static_cast<std::uint32_t>(whole(random, 1, 3));
    const double range = random() % 2 ? 0 : reference::real(random, 2, 9);
    const std::vector<LatticeMesh> meshes = scene.lattice();
    const int margin = static_cast<int>(layers) + 9;
    const auto sets = reference::united_scene(meshes, {}, margin);
    voxelize::BakeOptions options = distance_options(layers, range);
    // Every third scene has a soft covering, some thinner than a voxel.
    const double covering = seed % 3 == 0 ? reference::real(random, 0.5, 3) : 0;
    if (covering > 0) {
      options.compliance = {{covering / 3, 5e3}, {covering, 4e4}};
      if (range > 0) options.range_m = std::max(range, covering + 1);
    }
    double depth = std::max(1.0, covering), radius = layers - 1 + 888.0 / 1024;
    if (seed > 12) {
      depth = std::max(voxelize::kStandoffForceVoxels, covering);
      radius = seed % 4 == 0 ? 888.0 / 1024 : std::round(reference::real(random, 890, 3000)) / 1024;
      options.layers = 0;
      options.standoff_m = radius + depth;
    }
    const BakedScene baked(scene.objects(), options);
    const VoxmapHeader& header = baked.map().header();
    ASSERT_EQ(has_standoff(header), seed > 12);
    ASSERT_TRUE(audit_voxmap(baked.map(), "baked scene"));
    ASSERT_DOUBLE_EQ(header.zero_force_m, radius + depth);
    ASSERT_DOUBLE_EQ(header.force_depth_m, depth);
    // The upper bound has the writer's error; 1e-12 is for the rounding of these sums.
    ASSERT_LE(max_distance_m(header, 0) - kDistanceErrorVoxels * header.voxel_size_m,
              header.zero_force_m - options.range_m + 1e-12);
    ASSERT_GE(min_distance_m(header, kMaxDistanceCode), header.zero_force_m + 2.9);
    ASSERT_EQ(baked.map().compliance().empty(), covering == 0);
    const auto distance = [&](const lattice::VoxelIndex& v) {
      return distance_from(meshes, reference::center_of(v));
    };
    const Layers values(sets.interior, sets.geometry, static_cast<int>(std::ceil(depth)), distance,
                        radius);
    std::array<std::uint64_t, 4> counts{};
    sets.geometry.for_each([&](const lattice::VoxelIndex& v) {
      if (HasFatalFailure()) return;
      const VoxelValue value = baked.map().value(v[0], v[1], v[2]);
      ++counts[static_cast<std::size_t>(value)];
      ASSERT_EQ(value, values.at(v));
      const std::int64_t found = code_at(baked.map(), v);
      // Never above the distance, and less by no more than the error that a writer may make.
      const auto is_code_of = [&](double signed_distance) {
        return found >= code_of(header, signed_distance - 1e-3 - kTolerance) &&
               found <= code_of(header, signed_distance);
      };
      // The side of a surface voxel's center has a test of its own.
      const bool inside = sets.interior.at(v) == 1, surface = sets.geometry.at(v) == 1;
      ASSERT_TRUE(is_code_of(inside ? -distance(v) : distance(v)) ||
                  (surface && !inside && is_code_of(-distance(v))))
          << "code " << found << " at distance " << distance(v) << (inside ? ", inside" : "");
    });
    if (HasFatalFailure()) return;
    EXPECT_EQ(header.interior_voxels, counts[1]);
    EXPECT_EQ(header.surface_voxels, counts[2]);
    EXPECT_EQ(header.proximity_voxels, counts[3]);
  }
}

// Objects that are scaled, turned and moved to where they stand, at real voxel sizes, open sheets
// and closed bodies: every voxel has the value of the text (voxmap_format.md, sections 1 and 10).
// 0.035 / 0.005 is above 7 by rounding, and means 7.
TEST(DistanceBake, TurnedObjectsHaveTheValuesOfTheText) {
  int enclosed = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const double s = seed % 2 == 0 ? 0.005 : 0.003;
    const double depth_m = std::array{0.035, 0.0, 0.007, 0.0152}[seed % 4];
    mesh::Affine placing;
    const double a = reference::real(random, 0, 6), b = reference::real(random, 0, 6);
    const double turn[3][3] = {{std::cos(a), -std::sin(a) * std::cos(b), std::sin(a) * std::sin(b)},
                               {std::sin(a), std::cos(a) * std::cos(b), -std::cos(a) * std::sin(b)},
                               {0, std::sin(b), std::cos(b)}};
    for (std::size_t row = 0; row < 3; ++row) {
      for (std::size_t column = 0; column < 3; ++column) {
        placing.linear[row * 3 + column] = s * turn[row][column];
      }
      placing.translation[row] = reference::real(random, -3, 3);
    }
    std::vector<mesh::Mesh> meshes;
    for (int n = 0; n < 3; ++n) {
      const mesh::Vec3d middle{reference::real(random, -4, 4), reference::real(random, -4, 4),
                               reference::real(random, -4, 4)};
      meshes.push_back(reference::random_object(random, middle, reference::real(random, 2, 8)));
    }
    std::vector<LatticeMesh> corners;
    for (const mesh::Mesh& mesh : meshes) {
      LatticeMesh& to = corners.emplace_back();
      for (const mesh::Triangle& triangle : mesh.triangles) {
        lattice::LatticeTriangle& placed = to.emplace_back();
        for (std::size_t k = 0; k < 3; ++k) {
          const mesh::Vec3d world = mesh::apply(placing, mesh.vertices[triangle[k]]);
          for (std::size_t d = 0; d < 3; ++d) {
            placed[k][d] = static_cast<std::int64_t>(std::nearbyint(world[d] / s * 1024));
          }
        }
      }
    }
    const auto layers = static_cast<std::uint32_t>(seed % 3);
    const auto sets = reference::united_scene(corners, {}, 20);
    const auto objects = reference::objects_of(meshes, placing);
    const auto values = [](const BakedScene& scene, const lattice::VoxelIndex& v) {
      return scene.map().value(v[0], v[1], v[2]);
    };
    const BakedScene chebyshev(objects, reference::options_with(layers, s));
    const auto expected = reference::offset_scene(sets, static_cast<int>(layers));
    voxelize::BakeOptions options = reference::options_with(layers + 1, s, Metric::kEuclidean);
    if (depth_m > 0) options.compliance = {{depth_m, 4}};
    const BakedScene euclidean(objects, options);
    const double depth = std::max(1.0, depth_m / s);
    const Layers with_depth(
        sets.interior, sets.geometry, static_cast<int>(std::ceil(depth - 1e-9)),
        [&](const lattice::VoxelIndex& v) {
          return distance_from(corners, reference::center_of(v));
        },
        layers + 888.0 / 1024);
    sets.geometry.for_each([&](const lattice::VoxelIndex& v) {
      if (HasFatalFailure()) return;
      enclosed += sets.interior.at(v);
      ASSERT_EQ(static_cast<std::uint8_t>(values(chebyshev, v)), expected.at(v));
      ASSERT_EQ(values(euclidean, v), with_depth.at(v));
    });
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(enclosed, 0);
}

// Leaving the distances out changes no byte of the values.
TEST(DistanceBake, LeanFilesHaveTheSameValues) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, 40, 3);
    voxelize::BakeOptions options =
        distance_options(static_cast<std::uint32_t>(whole(random, 1, 3)));
    const auto full = voxelize::bake(scene.objects(), options);
    options.distances = false;
    const auto lean = voxelize::bake(scene.objects(), options);
    ASSERT_TRUE(full && lean);
    EXPECT_EQ(full->values.directory, lean->values.directory);
    EXPECT_EQ(full->values.upper_nodes, lean->values.upper_nodes);
    EXPECT_EQ(full->values.lower_nodes, lean->values.lower_nodes);
    EXPECT_EQ(full->values.bricks, lean->values.bricks);
    EXPECT_FALSE(full->distances.bricks.empty());
    EXPECT_TRUE(lean->distances.directory.empty());
    EXPECT_LT(voxmap_bytes(lean->content("")).size(), voxmap_bytes(full->content("")).size());
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
    const BakedScene baked(scene.objects(), distance_options(layers));
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

// Distances interpolated in a free voxel are beyond the zero-force surface, whatever the scene.
TEST(DistanceBake, NoForceBeginsInAFreeVoxel) {
  for (std::uint64_t seed = 1; seed <= 16; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, 10, 3);
    voxelize::BakeOptions options =
        distance_options(static_cast<std::uint32_t>(whole(random, 1, 3)));
    if (seed % 4 == 0) options.compliance = {{reference::real(random, 1, 3), 4}};
    if (seed % 4 == 3) {  // of any
      options.layers = 0;
      options.standoff_m = reference::real(random, 0.97, 4);
    }
    const BakedScene baked(scene.objects(), options);
    const VoxmapHeader& header = baked.map().header();
    const auto grid = reference::grid_around(scene.lattice(), 8);
    int near = 0;
    for (int n = 0; n < 40000; ++n) {
      lattice::VoxelIndex v;
      for (std::size_t d = 0; d < 3; ++d) v[d] = whole(random, grid.low()[d], grid.high()[d]);
      if (baked.map().value(v[0], v[1], v[2]) != VoxelValue::kFree) continue;
      near += baked.map().value(v[0] + 1, v[1], v[2]) != VoxelValue::kFree;
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
        code += weight * static_cast<double>(code_at(baked.map(), at));
      }
      const double distance =
          (code - header.distance_zero_code) * header.distance_quantum_m / header.voxel_size_m;
      ASSERT_GE(distance, header.zero_force_m / header.voxel_size_m);
    }
    EXPECT_GT(near, 100);
  }
}

// Whatever the standoff, a point on the other side of the mesh proves nothing, and no proof is
// above the distance (voxmap_format.md, section 13.4): the guard holds by it alone.
TEST(DistanceBake, DistancesProveNothingInsideAndNeverTooMuch) {
  int inside_points = 0, proven_points = 0, solids = 0;
  for (std::uint64_t seed = 1; seed <= 24; seed += test::seed_step(5)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    ++solids;
    mesh::Mesh mesh;  // a solid, convex or nearly so, whose side is known
    const Point center{reference::real(random, -9, 9), reference::real(random, -9, 9),
                       reference::real(random, -9, 9)};
    const double radius = reference::real(random, 1.2, 7);
    reference::add_sphere(mesh, {center[0], center[1], center[2]}, radius, 12);
    const std::vector<voxelize::SceneObject> objects{{"object", &mesh, mesh::Affine{}, {}, 0}};
    voxelize::BakeOptions options = distance_options(0);
    options.standoff_m = reference::real(random, 0.97, 2.5);
    const BakedScene baked(objects, options);
    const VoxmapHeader& header = baked.map().header();
    const std::vector<LatticeMesh> meshes{reference::snapped(mesh, mesh::Affine{}, 1)};
    for (int n = 0; n < 3000; ++n) {
      Point p;
      for (std::size_t d = 0; d < 3; ++d) {
        p[d] = center[d] + reference::real(random, -radius - 3, radius + 3);
      }
      lattice::VoxelIndex low;
      std::array<double, 3> t;
      double squared = 0;
      for (std::size_t d = 0; d < 3; ++d) {
        low[d] = static_cast<std::int64_t>(std::floor(p[d] - 0.5));
        t[d] = p[d] - 0.5 - static_cast<double>(low[d]);
        squared -= t[d] * (1 - t[d]);
      }
      for (unsigned c = 0; c < 8; ++c) {
        lattice::VoxelIndex at = low;
        double weight = 1;
        for (std::size_t d = 0; d < 3; ++d) {
          const bool other = (c >> d & 1) != 0;
          weight *= other ? t[d] : 1 - t[d];
          if (other) ++at[d];
        }
        const auto code = static_cast<std::uint32_t>(code_at(baked.map(), at));
        const double smallest = std::max(0.0, min_distance_m(header, code));
        squared += weight * smallest * smallest;
      }
      const double proven = squared > 0 ? std::sqrt(squared) : 0;
      // 1e-9: of double precision.
      ASSERT_LE(proven, distance_from(meshes, p) + 1e-9);
      proven_points += proven > 0.5;
      // Within the mesh's inscribed sphere: 12 segments reach it to 0.95 of the radius.
      if (std::hypot(p[0] - center[0], p[1] - center[1], p[2] - center[2]) > 0.93 * radius)
        continue;
      ++inside_points;
      ASSERT_LE(proven, 1e-4);
    }
  }
  EXPECT_GT(inside_points, 80 * solids);
  EXPECT_GT(proven_points, 400 * solids);
}

// Where the surface's voxels lie between inside and outside, distances go on through it evenly, so
// that every depth has a way out.
TEST(DistanceBake, DistancesGoThroughTheSurfaceEvenly) {
  Random random(3);
  mesh::Mesh mesh;
  reference::add_sphere(mesh, {0.3, 0.6, 0.1}, 14, 48);
  const std::vector<voxelize::SceneObject> objects{{"object", &mesh, mesh::Affine{}, {}, 0}};
  const BakedScene baked(objects, distance_options(2, 10));
  const VoxmapHeader& header = baked.map().header();
  const double quantum = header.distance_quantum_m;
  for (int n = 0; n < 4000; ++n) {
    lattice::VoxelIndex v;
    for (std::size_t d = 0; d < 3; ++d) v[d] = whole(random, -22, 22);
    const Point p = reference::center_of(v);
    const double distance = std::hypot(p[0] - 0.3, p[1] - 0.6, p[2] - 0.1) - 14;
    const std::int64_t code = code_at(baked.map(), v);
    if (code == 0 || code == kMaxDistanceCode) continue;
    // The mesh lies up to 0.04 voxels inside the sphere.
    ASSERT_NEAR(static_cast<double>(code - header.distance_zero_code), distance / quantum,
                1.1 + 0.05 / quantum);
  }
}

// In a voxel with surface the sign is that of the center's side, at the edges of solids too.
TEST(DistanceBake, SurfaceVoxelsHaveTheSideOfTheirCenter) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    // A box turned at random, at least three voxels thick.
    std::array<double, 9> axes{};
    std::array<double, 4> q{};
    double squared = 0;
    for (double& component : q) {
      component = reference::real(random, -1, 1);
      squared += component * component;
    }
    for (double& component : q) component /= std::sqrt(squared);
    const auto [w, x, y, z] = q;
    axes = {1 - 2 * (y * y + z * z), 2 * (x * y - z * w),     2 * (x * z + y * w),
            2 * (x * y + z * w),     1 - 2 * (x * x + z * z), 2 * (y * z - x * w),
            2 * (x * z - y * w),     2 * (y * z + x * w),     1 - 2 * (x * x + y * y)};
    std::array<double, 3> half{}, middle{};
    for (double& h : half) h = reference::real(random, 1.5, 9);
    for (double& m : middle) m = reference::real(random, -1, 1);
    mesh::Mesh mesh;
    reference::add_box(mesh, {-half[0], -half[1], -half[2]}, half);
    for (mesh::Vec3d& vertex : mesh.vertices) {
      const mesh::Vec3d at = vertex;
      for (std::size_t d = 0; d < 3; ++d) {
        vertex[d] =
            middle[d] + axes[3 * d] * at[0] + axes[3 * d + 1] * at[1] + axes[3 * d + 2] * at[2];
      }
    }
    const std::vector<voxelize::SceneObject> objects{{"box", &mesh, mesh::Affine{}, {}, 0}};
    const BakedScene baked(objects, distance_options(2, 6));
    const VoxmapHeader& header = baked.map().header();
    int near = 0;
    for (int n = 0; n < 20000; ++n) {
      lattice::VoxelIndex v;
      for (std::size_t d = 0; d < 3; ++d) v[d] = whole(random, -16, 16);
      const Point p = reference::center_of(v);
      double inside = -1e9;  // of the box's own coordinates
      for (std::size_t axis = 0; axis < 3; ++axis) {
        double along = 0;
        for (std::size_t d = 0; d < 3; ++d) along += axes[3 * d + axis] * (p[d] - middle[d]);
        inside = std::max(inside, std::abs(along) - half[axis]);
      }
      // Snapped corners are up to 0.001 voxels off; and outside, this is no distance at edges.
      if (std::abs(inside) < 0.01 || inside > 0.9 || inside < -0.9) continue;
      ++near;
      const std::int64_t code = code_at(baked.map(), v);
      ASSERT_EQ(code >= header.distance_zero_code, inside > 0)
          << "voxel " << v[0] << ' ' << v[1] << ' ' << v[2] << ", " << inside;
    }
    EXPECT_GT(near, 100);
  }
}

TEST(DistanceBake, SameBytesForAnyNumberOfThreadsOrderAndWholeVoxelShift) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    reference::MeshScene scene = reference::random_scene(random, 100, 3);
    voxelize::BakeOptions options = distance_options(2);
    options.objects = false;  // they are numbered in their order
    options.threads = 1;
    const BakedScene first(scene.objects(), options);
    options.threads = 4;
    std::shuffle(scene.meshes.begin(), scene.meshes.end(), random);
    for (mesh::Mesh& mesh : scene.meshes) {
      std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
      const bool turned = random() % 2 != 0;  // as a whole: closed surfaces are wound one way
      for (mesh::Triangle& triangle : mesh.triangles) {
        std::rotate(triangle.begin(), triangle.begin() + whole(random, 0, 2), triangle.end());
        if (turned) std::swap(triangle[0], triangle[1]);
      }
    }
    ASSERT_TRUE(BakedScene(scene.objects(), options).bytes() == first.bytes());
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
  static std::string bytes() {
    Random random(21);
    const reference::MeshScene scene = reference::random_scene(random, 60, 3);
    return BakedScene(scene.objects(), distance_options(2)).bytes();
  }
};
INSTANTIATE_TEST_SUITE_P(Targets, DistanceBakeOnEveryTarget,
                         ::testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& target) { return hwy::TargetName(target.param); });

TEST_P(DistanceBakeOnEveryTarget, GivesTheSameBytes) {
  const std::string here = bytes();
  use(0);
  EXPECT_EQ(bytes(), here);
}

TEST(DistanceBake, ARegionHasTheVoxelsOfTheWhole) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const reference::MeshScene scene = reference::random_scene(random, 24, 3);
    voxelize::BakeOptions options = distance_options(2);
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
          ASSERT_EQ(code_at(part.map(), v), inside ? code_at(all.map(), v) : kMaxDistanceCode);
        });
    if (HasFatalFailure()) return;
  }
}

}  // namespace
}  // namespace forcelayer

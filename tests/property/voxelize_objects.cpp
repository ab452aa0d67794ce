// The tree of nearest objects against the dense reference, what it may not depend on, and what a
// point in contact is named by it.
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "formats/audit/voxmap_audit.h"
#include "tests/support/baked_scene.h"
#include "tests/support/mesh_scene.h"
#include "tests/support/reference_distance.h"
#include "tests/support/sanitized.h"
#include "tests/support/soups.h"
#include "voxelize/distance/nearest_objects.h"
#include "voxelize/warnings.h"

namespace forcelayer {
namespace {

using reference::BakedScene;
using reference::LatticeMesh;
using reference::MeshScene;
using reference::Point;
using reference::Random;
using reference::real;
using reference::whole;

constexpr double kTolerance = 2e-4;  // of two distances in single precision, in voxels

voxelize::BakeOptions object_options(std::uint32_t layers = 2) {
  return reference::options_with(layers, 1, Metric::kEuclidean);
}

std::int64_t code_at(const Voxmap& map, const lattice::VoxelIndex& v) {
  std::array<std::int32_t, 3> at;
  for (std::size_t d = 0; d < 3; ++d) {
    at[d] = static_cast<std::int32_t>(v[d] - map.view().directory_origin[d]);
  }
  if (!map.distances()->contains(at[0], at[1], at[2])) return kMaxDistanceCode;
  return map.distances()->lookup(at[0], at[1], at[2]).code;
}
bool is_measured(const Voxmap& map, const lattice::VoxelIndex& v) {
  const std::int64_t code = code_at(map, v);
  return code != 0 && code != kMaxDistanceCode;
}
std::uint32_t object_at(const Voxmap& map, const lattice::VoxelIndex& v) {
  return map.nearest_object(v[0], v[1], v[2]);
}

// [objects] How far a point is from each, voxels.
std::vector<double> distances_from(const std::vector<LatticeMesh>& meshes, const Point& p) {
  std::vector<double> distances;
  for (const LatticeMesh& mesh : meshes) {
    double smallest = 1e300;
    for (const lattice::LatticeTriangle& triangle : mesh) {
      smallest = std::min(smallest, reference::point_distance(triangle, p));
    }
    distances.push_back(smallest);
  }
  return distances;
}

// Objects that overlap, that touch in whole faces, and that are the same mesh twice.
MeshScene crowded_scene(Random& random, double extent) {
  MeshScene scene = reference::random_scene(random, extent, 4);
  const mesh::Vec3d at = scene.meshes[0].vertices[0];
  for (std::int64_t n = whole(random, 1, 3); n > 0; --n) {
    switch (whole(random, 0, 2)) {
      case 0:
        scene.meshes.push_back(
            scene.meshes[static_cast<std::size_t>(whole(random, 0, 100)) % scene.meshes.size()]);
        break;
      case 1: {  // two boxes, one on the other
        const double size = real(random, 2, extent / 3);
        const mesh::Vec3d high{at[0] + size, at[1] + size, at[2] + size};
        reference::add_box(scene.meshes.emplace_back(), at, high);
        reference::add_box(scene.meshes.emplace_back(), {at[0], at[1], high[2]},
                           {high[0] - real(random, 0, size), high[1], high[2] + size / 2});
        break;
      }
      default: {
        mesh::Vec3d center = at;
        for (double& x : center) x += real(random, -extent / 3, extent / 3);
        scene.meshes.push_back(
            reference::random_object(random, center, real(random, 1, extent / 2)));
      }
    }
  }
  return scene;
}

TEST(ObjectBake, EqualsTheReferenceOnRandomScenes) {
  std::map<std::uint32_t, std::uint64_t> voxels_of;
  std::uint64_t ties = 0, bricks = 0;
  for (std::uint64_t seed = 1; seed <= 14; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const MeshScene scene = crowded_scene(random, seed % 4 == 0 ? 30 : 14);
    const std::vector<LatticeMesh> meshes = scene.lattice();
    voxelize::BakeOptions options = object_options(static_cast<std::uint32_t>(whole(random, 1, 3)));
    options.range_m = random() % 2 ? 0 : real(random, 2, 9);
    const BakedScene baked(scene.objects(), options);
    const Voxmap& map = baked.map();
    const Status audited = audit_voxmap(map, "scene");
    ASSERT_TRUE(audited) << to_line(audited.error());
    ASSERT_EQ(map.header().object_count, scene.meshes.size());
    bricks += map.object_counts().bricks;
    // The object numbers of each brick's measured voxels.
    std::map<lattice::VoxelIndex, std::set<std::uint32_t>> numbers;
    const auto brick_of = [](const lattice::VoxelIndex& v) {
      return lattice::VoxelIndex{v[0] >> 3, v[1] >> 3, v[2] >> 3};
    };
    const auto grid = reference::grid_around(meshes, options.layers + 14);
    grid.for_each([&](const lattice::VoxelIndex& v) {
      if (HasFatalFailure() || !is_measured(map, v)) return;
      const std::uint32_t found = object_at(map, v);
      ASSERT_GE(found, 1u);
      ASSERT_LE(found, scene.meshes.size());
      numbers[brick_of(v)].insert(found);
      ++voxels_of[found];
      const std::vector<double> distances = distances_from(meshes, reference::center_of(v));
      const double smallest = *std::min_element(distances.begin(), distances.end());
      ASSERT_LE(distances[found - 1], smallest + double{distance::kKernelErrorVoxels})
          << "object " << found;
      for (std::uint32_t other = 1; other < found; ++other) {
        ASSERT_GT(distances[other - 1],
                  smallest + double{distance::kEquallyNearVoxels} - kTolerance)
            << "object " << other << " is as near as object " << found;
      }
      for (std::uint32_t other = found + 1; other <= scene.meshes.size(); ++other) {
        ties += distances[other - 1] < smallest + 1e-9;
      }
    });
    if (HasFatalFailure()) return;
    grid.for_each([&](const lattice::VoxelIndex& v) {
      if (HasFatalFailure() || is_measured(map, v)) return;
      const auto in_brick = numbers.find(brick_of(v));
      ASSERT_EQ(object_at(map, v), in_brick == numbers.end() ? 0 : *in_brick->second.begin());
    });
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(voxels_of[1], 10000u);
  EXPECT_GT(voxels_of[2], 10000u);
  EXPECT_GT(voxels_of[3], 1000u);
  EXPECT_GT(ties, 10000u);
  EXPECT_GT(bricks, 100u);
}

// A point in a voxel that is not free gets the object that is nearest to it, where the next one
// is more than a voxel farther.
TEST(ObjectBake, IsRightForPointsInContact) {
  std::uint64_t right = 0, points = 0, of_others = 0, scenes = 0;
  for (std::uint64_t seed = 1; seed <= 16; seed += test::seed_step(5)) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    ++scenes;
    MeshScene scene;
    for (std::int64_t n = whole(random, 3, 6); n > 0; --n) {
      mesh::Vec3d center;
      for (double& x : center) x = real(random, -9, 9);
      scene.meshes.push_back(reference::random_object(random, center, real(random, 4, 16)));
    }
    const std::vector<LatticeMesh> meshes = scene.lattice();
    const BakedScene baked(scene.objects(), object_options());
    const auto grid = reference::grid_around(meshes, 5);
    for (int n = 0; n < 40000; ++n) {
      Point p;
      lattice::VoxelIndex v;
      for (std::size_t d = 0; d < 3; ++d) {
        p[d] =
            real(random, static_cast<double>(grid.low()[d]), static_cast<double>(grid.high()[d]));
        v[d] = static_cast<std::int64_t>(std::floor(p[d]));
      }
      const VoxelValue value = baked.map().value(v[0], v[1], v[2]);
      const bool contact = value == VoxelValue::kSurface || value == VoxelValue::kInterior;
      if (!contact || !is_measured(baked.map(), v)) continue;
      std::vector<double> distances = distances_from(meshes, p);
      const auto nearest = std::min_element(distances.begin(), distances.end());
      const auto object = static_cast<std::uint32_t>(nearest - distances.begin()) + 1;
      const double smallest = *nearest;
      *nearest = 1e300;
      if (*std::min_element(distances.begin(), distances.end()) <= smallest + 1) continue;
      ++points;
      right += object_at(baked.map(), v) == object;
      of_others += object != 1;
    }
  }
  EXPECT_GT(points, 3000 * scenes);
  EXPECT_GT(of_others, points / 2);
  EXPECT_GE(static_cast<double>(right), 0.99 * static_cast<double>(points))
      << right << " of " << points;
}

void shuffle_triangles(MeshScene& scene, Random& random) {
  for (mesh::Mesh& mesh : scene.meshes) {
    std::shuffle(mesh.triangles.begin(), mesh.triangles.end(), random);
    const bool turned = random() % 2 != 0;  // as a whole: closed surfaces are wound one way
    for (mesh::Triangle& triangle : mesh.triangles) {
      std::rotate(triangle.begin(), triangle.begin() + whole(random, 0, 2), triangle.end());
      if (turned) std::swap(triangle[0], triangle[1]);
    }
  }
}

TEST(ObjectBake, SameBytesForAnyNumberOfThreadsAndOrderOfTriangles) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    MeshScene scene = crowded_scene(random, 100);
    voxelize::BakeOptions options = object_options();
    options.threads = 1;
    const BakedScene first(scene.objects(), options);
    ASSERT_NE(first.map().objects(), nullptr);
    options.threads = 2;
    ASSERT_EQ(BakedScene(scene.objects(), options).bytes(), first.bytes());
    shuffle_triangles(scene, random);
    ASSERT_EQ(BakedScene(scene.objects(), options).bytes(), first.bytes());
  }
}

void expect_equal_trees(const tree::VoxelTree& a, const tree::VoxelTree& b) {
  EXPECT_EQ(a.directory, b.directory);
  EXPECT_EQ(a.upper_nodes, b.upper_nodes);
  EXPECT_EQ(a.lower_nodes, b.lower_nodes);
  EXPECT_EQ(a.bricks, b.bricks);
}

// Another order of the objects gives them other numbers, and that is all.
TEST(ObjectBake, TheOrderOfObjectsGivesTheNumbersAlone) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const MeshScene scene = crowded_scene(random, 24);
    MeshScene turned = scene;
    std::reverse(turned.meshes.begin(), turned.meshes.end());
    const voxelize::BakeOptions options = object_options();
    const auto a = voxelize::bake(scene.objects(), options),
               b = voxelize::bake(turned.objects(), options);
    ASSERT_TRUE(a && b);
    expect_equal_trees(a->values, b->values);
    expect_equal_trees(a->distances, b->distances);
    const BakedScene one(scene.objects(), options), other(turned.objects(), options);
    const std::vector<LatticeMesh> meshes = scene.lattice();
    const auto count = static_cast<std::uint32_t>(scene.meshes.size());
    reference::grid_around(meshes, 8).for_each([&](const lattice::VoxelIndex& v) {
      if (HasFatalFailure() || !is_measured(one.map(), v)) return;
      const std::uint32_t here = object_at(one.map(), v), there = object_at(other.map(), v);
      if (here == count + 1 - there) return;
      const std::vector<double> distances = distances_from(meshes, reference::center_of(v));
      ASSERT_NEAR(distances[here - 1], distances[count - there],
                  double{distance::kKernelErrorVoxels});
      ASSERT_LT(here, count + 1 - there) << "of equally near ones the first";
    });
    if (HasFatalFailure()) return;
  }
}

// Leaving the objects out changes no byte of the other trees.
TEST(ObjectBake, FilesWithoutObjectsHaveTheSameValuesAndDistances) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const MeshScene scene = crowded_scene(random, 40);
    voxelize::BakeOptions options = object_options(static_cast<std::uint32_t>(whole(random, 1, 3)));
    const auto with = voxelize::bake(scene.objects(), options);
    options.objects = false;
    const auto without = voxelize::bake(scene.objects(), options);
    options.distances = false;
    const auto lean = voxelize::bake(scene.objects(), options);
    ASSERT_TRUE(with && without && lean);
    expect_equal_trees(with->values, without->values);
    expect_equal_trees(with->values, lean->values);
    expect_equal_trees(with->distances, without->distances);
    EXPECT_FALSE(with->nearest_objects.directory.empty());
    for (const auto* bake : {&*without, &*lean}) {
      EXPECT_TRUE(bake->nearest_objects.directory.empty());
      EXPECT_TRUE(bake->object_names.empty());
      EXPECT_EQ(bake->header.object_count, 0u);
    }
  }
}

TEST(ObjectBake, ARegionHasTheObjectsOfTheWhole) {
  std::uint64_t compared = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    Random random(seed);
    const MeshScene scene = crowded_scene(random, 30);
    voxelize::BakeOptions options = object_options();
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
    ASSERT_EQ(part.map().header().object_count, scene.meshes.size());
    reference::DenseGrid({low[0] - 9, low[1] - 9, low[2] - 9},
                         {high[0] + 9, high[1] + 9, high[2] + 9})
        .for_each([&](const lattice::VoxelIndex& v) {
          bool inside = true;
          for (std::size_t d = 0; d < 3; ++d) inside &= v[d] >= low[d] && v[d] < high[d];
          if (HasFatalFailure()) return;
          if (!inside) {
            ASSERT_EQ(object_at(part.map(), v), 0u);
          } else if (is_measured(part.map(), v)) {
            ASSERT_EQ(object_at(part.map(), v), object_at(all.map(), v));
            ++compared;
          }
        });
    if (HasFatalFailure()) return;
  }
  EXPECT_GT(compared, 10000u);
}

// One object takes no brick.
TEST(ObjectBake, OfOneObjectIsUniform) {
  Random random(5);
  MeshScene scene;
  scene.meshes.push_back(reference::random_object(random, {3, 4, 5}, 60));
  const BakedScene baked(scene.objects(), object_options());
  EXPECT_EQ(baked.map().header().object_count, 1u);
  EXPECT_EQ(baked.map().object_counts().bricks, 0u);
  EXPECT_EQ(baked.map().object_name(1), "object");
}

TEST(ObjectBake, NamesAreUtf8AndOneEach) {
  Random random(6);
  MeshScene scene;
  for (double x : {0.0, 30.0, 60.0, 90.0}) {
    reference::add_box(scene.meshes.emplace_back(), {x, 0, 0}, {x + 9, 9, 9});
  }
  std::vector<voxelize::SceneObject> objects = scene.objects();
  using namespace std::string_literals;
  objects[0].name = "Gehäuse/Deckel#2";
  objects[1].name = "a\0b"s;
  objects[2].name = "\xff line\nend \xe4";
  objects[3].name = "";
  const BakedScene baked(objects, object_options());
  EXPECT_EQ(baked.map().object_name(1), "Gehäuse/Deckel#2");
  EXPECT_EQ(baked.map().object_name(2),
            "a\xef\xbf\xbd"
            "b");
  EXPECT_EQ(baked.map().object_name(3), "\xef\xbf\xbd line\nend \xef\xbf\xbd");
  EXPECT_EQ(baked.map().object_name(4), "");
  for (std::uint32_t n = 0; n < 4; ++n) {
    EXPECT_EQ(object_at(baked.map(), {30 * std::int64_t{n} - 1, 4, 4}), n + 1);
  }
}

// More objects than a file can name.
TEST(ObjectBake, OfTooManyObjectsTellsNoneApart) {
  const mesh::Mesh empty;
  mesh::Mesh box;
  reference::add_box(box, {0, 0, 0}, {9, 9, 9});
  for (const std::size_t count : {std::size_t{kMaxObjects}, std::size_t{kMaxObjects} + 1}) {
    SCOPED_TRACE(count);
    const bool too_many = count > kMaxObjects;
    std::vector<voxelize::SceneObject> objects(count, {"object", &empty, mesh::Affine{}, {}, 0});
    objects.back().mesh = &box;
    const BakedScene baked(objects, object_options());
    EXPECT_NE(baked.map().distances(), nullptr);
    EXPECT_EQ(baked.map().header().object_count, too_many ? 0 : kMaxObjects);
    EXPECT_EQ(object_at(baked.map(), {-1, 4, 4}), too_many ? 0 : kMaxObjects);
    mesh::Scene scene;
    scene.objects.resize(count);
    const std::vector<cache::MeshOutline> outlines(count);
    const auto warnings = voxelize::all_warnings(scene, outlines, object_options());
    ASSERT_EQ(warnings.size(), too_many ? 1u : 0u);
    for (const std::string& warning : warnings) {
      EXPECT_NE(warning.find("at most 65535 objects, but the scene has 65536"), std::string::npos)
          << warning;
    }
    voxelize::BakeOptions lean = object_options();
    lean.distances = false;
    EXPECT_TRUE(voxelize::all_warnings(scene, outlines, lean).empty());
  }
}

}  // namespace
}  // namespace forcelayer

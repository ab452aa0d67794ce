// Digests of a cache's entries: fails where an algorithm's output has changed and its version
// in voxelize/cache/cache_versions.h has not, since old entries would then be taken for new ones.
#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "formats/mesh/mesh_facts.h"
#include "formats/mesh/scene.h"
#include "tests/support/baked_scene.h"
#include "tests/support/places.h"
#include "voxelize/cache/cache_versions.h"
#include "voxelize/cache/digest.h"
#include "voxelize/cache/mesh_source.h"

namespace forcelayer {
namespace {

using reference::BakedScene;

struct Golden {
  const char* stage;
  std::uint64_t version;
  const char* digest;
};

// Never change a line: raise the version, and add one.
constexpr Golden kGolden[] = {
    {"assembly", 2, "7e7b61859842d11bf3d865ed9446ae25"},
    {"assembly", 3, "7e7b61859842d11bf3d865ed9446ae25"},
    {"assembly", 4, "7e7b61859842d11bf3d865ed9446ae25"},
    {"assembly", 5, "f6e75e8a9fe5634b1d86fdd84a9fb607"},
    {"assembly", 6, "f6e75e8a9fe5634b1d86fdd84a9fb607"},
    {"assembly", 7, "245b6907d41801772ddd04f41fbe4c3c"},
    {"facts", 1, "5969afd315368bd0abbc5d4dca1f187a"},
    {"facts", 2, "fcfbcefe46e36be7d9621d4221e13b94"},
    {"part", 1, "1c4d57068bd7dcebb03b7856ce94f27c"},
    {"part", 2, "1c4d57068bd7dcebb03b7856ce94f27c"},
    {"part", 3, "1c4d57068bd7dcebb03b7856ce94f27c"},
    {"node", 1, "b3fc25335a66c7ce49d0e54e610980d0"},
    {"distance", 1, "dced7f28bc28ea459de843b666334c3c"},
    {"distance", 2, "dced7f28bc28ea459de843b666334c3c"},
    {"distance", 3, "05236e93d71372c5975629dec3ad961d"},
    {"distance", 4, "3db16d9acd3feaa4eebf20d8381ea597"},
    {"near voxels", 2, "90bd1485eae1eddd72590f4c2a8fca18"},
    {"near voxels", 3, "90bd1485eae1eddd72590f4c2a8fca18"},
};

void expect_golden(const std::string& stage, std::uint64_t version, const cache::Digest& found) {
  for (const Golden& golden : kGolden) {
    if (golden.stage != stage || golden.version != version) continue;
    EXPECT_EQ(found.hex(), golden.digest)
        << "the " << stage << " stage gives something else than version " << version
        << " did: raise its version in voxelize/cache/cache_versions.h, and add a line here";
    return;
  }
  ADD_FAILURE() << "add {\"" << stage << "\", " << version << ", \"" << found.hex()
                << "\"} to the golden digests";
}

// A mesh that is the same on every machine: the generator's raw numbers, no distribution. Slivers,
// large and small triangles, and three nested boxes that enclose cavities; in units of 1/64.
mesh::Mesh golden_mesh(std::uint64_t seed) {
  mesh::Mesh mesh;
  std::mt19937_64 random(seed);
  const auto number = [&](std::uint64_t below) { return static_cast<double>(random() % below); };
  for (int n = 0; n < 400; ++n) {
    const double reach = std::array{64., 300., 2000., 6000.}[n % 4];
    const mesh::Vec3d at = {number(6000), number(6000), number(6000)};
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int k = 0; k < 3; ++k) {
      mesh::Vec3d vertex;
      for (std::size_t d = 0; d < 3; ++d) {
        vertex[d] = (at[d] + number(static_cast<std::uint64_t>(reach))) / 64;
      }
      mesh.vertices.push_back(vertex);
    }
    mesh.triangles.push_back({first, first + 1, first + (n % 50 == 0 ? 1u : 2u)});
  }
  constexpr unsigned kFaces[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1},
                                     {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
  for (const double size : {45.0, 33.25, 20.5}) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (unsigned n = 0; n < 8; ++n) {
      mesh::Vec3d corner;
      for (std::size_t d = 0; d < 3; ++d) corner[d] = 140 + (n >> d & 1 ? size : -size);
      mesh.vertices.push_back(corner);
    }
    for (const auto& face : kFaces) {
      mesh.triangles.push_back({first + face[0], first + face[1], first + face[2]});
      mesh.triangles.push_back({first + face[0], first + face[2], first + face[3]});
    }
  }
  return mesh;
}

// Longer than 512 voxels, beyond which triangles are tested in wider integers.
mesh::Mesh golden_sliver() {
  mesh::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {800.25, 9.5, 20}, {790, 1.75, 3}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

// Turned by the angle of a 3-4-5 triangle, in voxels of 1 m.
std::vector<voxelize::SceneObject> golden_objects(const std::vector<mesh::Mesh>& meshes) {
  mesh::Affine turned;
  turned.linear = {0.8, -0.6, 0, 0.6, 0.8, 0, 0, 0, 1};
  turned.translation = {-31.125, 17.75, 1000.5};
  std::vector<voxelize::SceneObject> objects;
  for (const mesh::Mesh& mesh : meshes) {
    objects.push_back({"object", &mesh, objects.empty() ? mesh::Affine{} : turned, {}, 0});
  }
  return objects;
}

voxelize::BakeOptions golden_options(std::uint32_t layers) {
  voxelize::BakeOptions options;
  options.voxel_size_m = 1;
  options.layers = layers;
  options.metric = Metric::kChebyshev;
  options.find_cavities = true;
  options.threads = 2;
  return options;
}

// Every voxel's value, whatever the tree looks like.
void add_values(cache::DigestBuilder& digest, const BakedScene& scene) {
  const VoxmapHeader& header = scene.map().header();
  std::vector<std::uint8_t> row(header.dims_voxels[2]);
  const auto& [x0, y0, z0] = header.origin_voxel;
  for (std::uint64_t x = 0; x < header.dims_voxels[0]; ++x) {
    for (std::uint64_t y = 0; y < header.dims_voxels[1]; ++y) {
      for (std::uint64_t z = 0; z < row.size(); ++z) {
        row[z] = static_cast<std::uint8_t>(scene.map().value(x0 + static_cast<std::int64_t>(x),
                                                             y0 + static_cast<std::int64_t>(y),
                                                             z0 + static_cast<std::int64_t>(z)));
      }
      digest.bytes(std::as_bytes(std::span(row)));
    }
  }
}

// Every reader through the sample data: STL, OBJ, PLY, OFF, glTF.
TEST(CacheVersions, OfAssembliesAndFacts) {
  cache::DigestBuilder meshes, facts;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(test::source_path("sample_data"))) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".json" || extension == ".csv" || extension.empty()) continue;
    if (entry.path().stem() == "gearbox") continue;  // younger than the digests
    files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  ASSERT_GE(files.size(), 7u);
  for (const auto& file : files) {
    const auto assembly = mesh::read_assembly(file.string());
    ASSERT_TRUE(assembly) << to_line(assembly.error());
    for (const mesh::Mesh& mesh : assembly->meshes) {
      meshes.value(cache::outline_of(mesh).digest());
      const mesh::MeshFacts f = mesh::mesh_facts(mesh);
      for (const std::uint64_t count :
           {f.triangles, f.vertices, f.distinct_vertices, f.degenerate_triangles,
            f.duplicate_triangles, f.boundary_edges, f.non_manifold_edges, f.flipped_edges}) {
        facts.value(count);
      }
      for (const double x : {f.min[0], f.min[1], f.min[2], f.max[0], f.max[1], f.max[2]}) {
        facts.value(x);
      }
    }
    for (const mesh::MeshInstance& instance : assembly->instances) {
      meshes.value(std::uint64_t{instance.mesh}).text(instance.name);
      for (const double x : instance.assembly_from_mesh.linear) meshes.value(x);
      for (const double x : instance.assembly_from_mesh.translation) meshes.value(x);
      meshes.value(instance.deviation_units);
    }
    meshes.value(assembly->meters_per_unit.value_or(0));
    for (const std::string& warning : assembly->warnings) meshes.text(warning);
  }
  expect_golden("assembly", cache::kAssemblyCacheVersion, meshes.finish());
  expect_golden("facts", cache::kFactsCacheVersion, facts.finish());
}

// G and I: the plain classification, read voxel by voxel whatever the tree looks like.
TEST(CacheVersions, OfObjects) {
  const std::vector<mesh::Mesh> meshes = {golden_sliver(), golden_mesh(1), golden_mesh(2)};
  cache::DigestBuilder digest;
  for (const voxelize::SceneObject& object : golden_objects(meshes)) {
    const auto baked = voxelize::bake(std::span(&object, 1), golden_options(0));
    ASSERT_TRUE(baked) << to_line(baked.error());
    const voxelize::ObjectReport& report = baked->objects[0];
    if (report.triangles > 1) {
      ASSERT_GT(report.cavity_count, 2u);
      ASSERT_GT(report.degenerate_triangles, 0u);
    }
    for (const std::uint64_t count :
         {report.triangles, report.degenerate_triangles, report.geometry_voxels,
          report.interior_voxels, report.cavity_count}) {
      digest.value(count);
    }
    for (const fill::Cavity& cavity : report.cavities) {
      digest.value(cavity.voxels);
      for (const std::int64_t x : cavity.seed_voxel) digest.value(x);
    }
    add_values(digest, BakedScene({object}, golden_options(0)));
  }
  expect_golden("part", cache::kObjectCacheVersion, digest.finish());
}

// Surfaces grown by Euclidean distance, among them a needle that points at the center of a voxel.
TEST(CacheVersions, OfGrownSurfaces) {
  mesh::Mesh needle;
  constexpr double kUnit = 1.0 / 1024;
  needle.vertices = {{14738 * kUnit, 26002 * kUnit, 52626 * kUnit},
                     {-19131 * kUnit, -7867 * kUnit, 18757 * kUnit},
                     {-19131 * kUnit, -7866 * kUnit, 18757 * kUnit}};
  needle.triangles = {{0, 1, 2}};
  const std::vector<mesh::Mesh> meshes = {needle, golden_sliver(), golden_mesh(1), golden_mesh(2)};
  voxelize::BakeOptions options = golden_options(2);
  options.metric = Metric::kEuclidean;
  cache::DigestBuilder digest;
  for (const voxelize::SceneObject& object : golden_objects(meshes)) {
    add_values(digest, BakedScene({object}, options));
  }
  expect_golden("near voxels", cache::kGrowthCacheVersion, digest.finish());
}

// Distances and nearest objects.
TEST(CacheVersions, OfDistances) {
  const std::vector<mesh::Mesh> meshes = {golden_sliver(), golden_mesh(1), golden_mesh(2)};
  cache::DigestBuilder digest;
  for (const std::uint32_t layers : {1u, 3u}) {
    voxelize::BakeOptions options = golden_options(layers);
    options.metric = Metric::kEuclidean;
    const auto baked = voxelize::bake(golden_objects(meshes), options);
    ASSERT_TRUE(baked) << to_line(baked.error());
    for (const tree::VoxelTree* tree : {&baked->distances, &baked->nearest_objects}) {
      for (const auto* words :
           {&tree->directory, &tree->upper_nodes, &tree->lower_nodes, &tree->bricks}) {
        digest.bytes(std::as_bytes(std::span(*words)));
      }
    }
  }
  expect_golden("distance", cache::kDistanceCacheVersion, digest.finish());
}

// The finished tree, bricks and clearance included.
TEST(CacheVersions, OfNodes) {
  const std::vector<mesh::Mesh> meshes = {golden_sliver(), golden_mesh(1), golden_mesh(2)};
  cache::DigestBuilder digest;
  for (const std::uint32_t layers : {0u, 1u, 2u, 5u}) {
    const auto baked = voxelize::bake(golden_objects(meshes), golden_options(layers));
    ASSERT_TRUE(baked) << to_line(baked.error());
    for (const auto* words : {&baked->values.directory, &baked->values.upper_nodes,
                              &baked->values.lower_nodes, &baked->values.bricks}) {
      digest.bytes(std::as_bytes(std::span(*words)));
    }
  }
  expect_golden("node", cache::kNodeCacheVersion, digest.finish());
}

}  // namespace
}  // namespace forcelayer

// One small scene that voxelize bakes in every kind of voxels: the same bytes for ever. The
// files are seeds of the fuzz targets as well.
#include <gtest/gtest.h>

#include "formats/audit/voxmap_audit.h"
#include "tests/support/baked_scene.h"
#include "tests/support/golden_bytes.h"

namespace forcelayer {
namespace {

// A tilted wedge that is closed, with a sheet beside it; coordinates in 1/64 voxel of 1 mm, so that
// they are the same on every machine. All that is not free stays in one node.
mesh::Mesh golden_scene() {
  constexpr double kUnit = 0.001 / 64;
  mesh::Mesh mesh;
  mesh.vertices = {{1301, 1283, 1290}, {1795, 1340, 1333}, {1380, 1740, 1405}, {1455, 1420, 1801},
                   {1960, 1500, 1310}, {1980, 1910, 1350}, {1900, 1530, 1777}};
  for (mesh::Vec3d& vertex : mesh.vertices)
    for (double& x : vertex) x *= kUnit;
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {4, 5, 6}};
  return mesh;
}

std::vector<std::byte> baked(const std::vector<voxelize::SceneObject>& objects,
                             voxelize::BakeOptions options) {
  options.voxel_size_m = 0.001;
  options.threads = 2;
  const auto result = voxelize::bake(objects, options);
  if (!result) throw std::runtime_error(to_line(result.error()));
  return voxmap_bytes(result->content("{}"));
}

std::vector<std::byte> baked(const voxelize::BakeOptions& options) {
  const mesh::Mesh mesh = golden_scene();
  return baked({{"object", &mesh, mesh::Affine{}, {}, 0}}, options);
}

TEST(GoldenKinds, Chebyshev) {
  voxelize::BakeOptions options;
  options.metric = Metric::kChebyshev;
  testing::expect_golden_bytes("baked_chebyshev.vox", baked(options));
}

TEST(GoldenKinds, Lean) {
  voxelize::BakeOptions options;
  options.distances = false;
  testing::expect_golden_bytes("baked_lean.vox", baked(options));
}

TEST(GoldenKinds, Full) { testing::expect_golden_bytes("baked_full.vox", baked({})); }

TEST(GoldenKinds, SoftCovering) {
  voxelize::BakeOptions options;
  options.compliance = {{0.001, 5e3}, {0.0025, 4e4}};
  testing::expect_golden_bytes("baked_covered.vox", baked(options));
}

TEST(GoldenKinds, TwoObjects) {
  mesh::Mesh wedge = golden_scene(), sheet = golden_scene();
  wedge.triangles.pop_back();
  sheet.triangles = {sheet.triangles.back()};
  testing::expect_golden_bytes(
      "baked_objects.vox",
      baked({{"wedge", &wedge, mesh::Affine{}, {}, 0}, {"sheet", &sheet, mesh::Affine{}, {}, 0}},
            {}));
}

// The files say what they are to a reader of today, and all that they say is true.
TEST(GoldenKinds, AreRead) {
  const struct {
    const char* name;
    Metric metric;
    bool distances, covered;
    std::uint32_t objects;
  } files[] = {{"baked_chebyshev.vox", Metric::kChebyshev, false, false, 0},
               {"baked_lean.vox", Metric::kEuclidean, false, false, 0},
               {"baked_full.vox", Metric::kEuclidean, true, false, 1},
               {"baked_covered.vox", Metric::kEuclidean, true, true, 1},
               {"baked_objects.vox", Metric::kEuclidean, true, false, 2}};
  for (const auto& file : files) {
    SCOPED_TRACE(file.name);
    const auto map = Voxmap::open(testing::golden_path(file.name), Verify::kStructureAndChecksums);
    ASSERT_TRUE(map) << to_line(map.error());
    const Status audited = audit_voxmap(*map, file.name);
    EXPECT_TRUE(audited) << to_line(audited.error());
    EXPECT_EQ(map->header().metric, static_cast<std::uint32_t>(file.metric));
    EXPECT_EQ(map->distances() != nullptr, file.distances);
    EXPECT_EQ(!map->compliance().empty(), file.covered);
    EXPECT_EQ(map->header().object_count, file.objects);
    EXPECT_EQ(map->object_counts().bricks > 0, file.objects > 1);
    EXPECT_GT(map->header().surface_voxels, 500u);
    EXPECT_EQ(map->lower_node_count(), 1u);
  }
}

}  // namespace
}  // namespace forcelayer

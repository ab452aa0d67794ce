// The audit of scenes that fill few of many directory cells.
#include <gtest/gtest.h>

#include <random>

#include "formats/audit/voxmap_audit.h"
#include "tests/support/baked_scene.h"
#include "tests/support/file_surgery.h"

namespace forcelayer {
namespace {

using reference::BakedScene;
using testing::AlignedBytes;

// Single triangles of a few voxels, up to `extent` voxels apart along each axis.
std::vector<mesh::Mesh> far_triangles(std::mt19937_64& random, const std::array<int, 3>& extent) {
  std::vector<mesh::Mesh> meshes(2 + random() % 5);
  for (mesh::Mesh& mesh : meshes) {
    std::array<double, 3> place{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      place[axis] = std::uniform_real_distribution<double>(0, extent[axis])(random);
    }
    for (int corner = 0; corner < 3; ++corner) {
      mesh.vertices.push_back(place);
      for (double& x : mesh.vertices.back()) {
        x += std::uniform_real_distribution<double>(-4, 4)(random);
      }
    }
    mesh.triangles.push_back({0, 1, 2});
  }
  return meshes;
}

Status audit(AlignedBytes& bytes) {
  testing::resign(bytes.bytes());
  const auto map = Voxmap::from_bytes(bytes.bytes(), "far", Verify::kStructureAndChecksums);
  return map ? audit_voxmap(*map, "far") : Status(map.error());
}

// A cell's clearance is the distance to the nearest voxel that is not free, so one more is a lie.
TEST(FarScenes, EveryClearanceOfACellThatIsTooLargeIsNoticed) {
  constexpr auto kDirectory = static_cast<std::uint32_t>(VoxmapSection::kDirectory);
  int raised = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    const std::array<int, 3> extent =
        seed % 2 ? std::array<int, 3>{40000, 900, 10} : std::array<int, 3>{5000, 4000, 6000};
    const std::vector<mesh::Mesh> meshes = far_triangles(random, extent);
    const BakedScene scene(reference::objects_of(meshes), reference::options_with(2));
    AlignedBytes bytes(scene.map().bytes());
    ASSERT_TRUE(audit(bytes));
    const auto entry = testing::read_at<SectionEntry>(
        bytes.bytes(), testing::table_entry_of(bytes.bytes(), kDirectory));
    const std::size_t step = std::max<std::size_t>(1, entry.bytes / 4 / 40);
    for (std::size_t n = 0; n < entry.bytes / 4; n += step) {
      const std::size_t at = entry.offset + 4 * n;
      const auto word = testing::read_at<std::uint32_t>(bytes.bytes(), at);
      if (!is_uniform(word) || uniform_value(word) != 0) continue;
      testing::write_at(bytes.bytes(), at, uniform_entry(0, uniform_clearance(word) + 1));
      ASSERT_FALSE(audit(bytes)) << "cell " << n << ", clearance " << uniform_clearance(word);
      testing::write_at(bytes.bytes(), at, word);
      ++raised;
    }
  }
  EXPECT_GT(raised, 150);
}

// A million meters between two triangles: 400,000 free cells, whose look-arounds were 10^10 steps.
TEST(FarScenes, TheAuditTakesTimeInProportionToTheFile) {
  mesh::Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2e8, 0, 0}, {2e8, 1, 0}, {2e8, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  const BakedScene scene(reference::objects_of({mesh}), reference::options_with(2));
  EXPECT_GT(scene.map().view().directory_dims[0], 390000);
  EXPECT_TRUE(audit_voxmap(scene.map(), "far"));
}

}  // namespace
}  // namespace forcelayer

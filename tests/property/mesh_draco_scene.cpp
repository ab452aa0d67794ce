// The reader of glTF against Draco's, on an assembly.
#include <draco/io/scene_io.h>
#include <draco/scene/scene_utils.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/support/engine_glb.h"

namespace forcelayer {
namespace {

using namespace test;

// Triangles of all instances with their corners in scene coordinates, in micro-units, sorted: the
// two readers order triangles and corners differently and round transforms differently.
using Key = std::array<std::array<std::int64_t, 3>, 3>;

Key key_of(std::array<mesh::Vec3d, 3> corners) {
  Key key;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      key[i][axis] = std::llround(corners[i][axis] * 1e3);
    }
  }
  std::sort(key.begin(), key.end());
  return key;
}

std::vector<Key> keys_by_draco(const draco::Scene& scene) {
  std::vector<Key> keys;
  const auto instances = draco::SceneUtils::ComputeAllInstances(scene);
  for (draco::MeshInstanceIndex i(0); i < instances.size(); ++i) {
    const draco::Mesh& mesh = scene.GetMesh(instances[i].mesh_index);
    const draco::PointAttribute& positions =
        *mesh.GetNamedAttribute(draco::GeometryAttribute::POSITION);
    for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
      std::array<mesh::Vec3d, 3> corners;
      for (int c = 0; c < 3; ++c) {
        std::array<float, 3> p{};
        positions.ConvertValue(positions.mapped_index(mesh.face(f)[c]), p.data());
        const Eigen::Vector4d placed =
            instances[i].transform * Eigen::Vector4d(p[0], p[1], p[2], 1);
        corners[static_cast<std::size_t>(c)] = {placed[0], placed[1], placed[2]};
      }
      keys.push_back(key_of(corners));
    }
  }
  return keys;
}

TEST(GltfReader, AgreesWithDracoOnTheEngine) {
  const ScratchFolder folder;
  const std::string path = write_file(folder / "engine.glb", engine_glb());
  const auto scene = draco::ReadSceneFromFile(path);
  ASSERT_TRUE(scene.ok());
  const auto assembly = mesh::read_assembly(path, {.up = mesh::Up::kY});
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  EXPECT_EQ(assembly->triangle_count(), kEngineTriangles);
  EXPECT_EQ(assembly->instances.size(), 34u);
  EXPECT_EQ(assembly->meshes.size(), 4u);
  std::vector<Key> theirs = keys_by_draco(*scene.value()), ours;
  for (const auto& corners : corners_of(*assembly)) ours.push_back(key_of(corners));
  ASSERT_EQ(ours.size(), theirs.size());
  std::sort(ours.begin(), ours.end());
  std::sort(theirs.begin(), theirs.end());
  std::vector<Key> different;
  std::set_symmetric_difference(ours.begin(), ours.end(), theirs.begin(), theirs.end(),
                                std::back_inserter(different));
  // Coordinates at the middle between two thousandths may round either way.
  EXPECT_LT(different.size(), ours.size() / 500);
}

}  // namespace
}  // namespace forcelayer

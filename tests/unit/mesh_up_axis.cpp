// The world is z up: glTF, which is y up, is turned, and other formats are not.
#include "formats/mesh/up_axis.h"

#include <gtest/gtest.h>

#include "formats/command/provenance.h"
#include "formats/mesh/scene.h"
#include "tests/support/mesh_files.h"
#include "tests/support/scratch_folder.h"

namespace forcelayer {
namespace {

using namespace test;

// A cube at 1, 2, 3, under a node that is turned and mirrored.
constexpr const char* kNodes =
    R"([{"name":"top","children":[1,2],"translation":[10,20,30]},)"
    R"({"name":"a","mesh":0,"translation":[1,2,3]},)"
    R"({"name":"b","mesh":0,"rotation":[0,0,0.70710677,0.70710677],"scale":[2,3,-4]}])";

std::string two_cubes() { return as_glb(gltf_json(cube(), kNodes), gltf_binary(cube())); }

TEST(UpAxis, OfGltfIsTurned) {
  const std::string bytes = two_cubes();
  const auto turned = mesh::read_source({"a.glb", bytes, {}});
  const auto kept = mesh::read_source({"a.glb", bytes, {.up = mesh::Up::kY}});
  ASSERT_TRUE(turned && kept);
  EXPECT_EQ(turned->up, mesh::Up::kZ);
  EXPECT_EQ(kept->up, mesh::Up::kY);
  const Corners a = corners_of(*turned), b = corners_of(*kept);
  ASSERT_EQ(a.size(), 24u);
  ASSERT_EQ(b.size(), 24u);
  for (std::size_t t = 0; t < a.size(); ++t) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto& [x, y, z] = b[t][corner];
      EXPECT_EQ(a[t][corner], (mesh::Vec3d{x, -z, y})) << t;
    }
  }
  const mesh::Box &box = turned->instances[0].box, &box_kept = kept->instances[0].box;
  EXPECT_EQ(box.low, (mesh::Vec3d{box_kept.low[0], -box_kept.high[2], box_kept.low[1]}));
  EXPECT_EQ(turned->instances[0].assembly_from_mesh.translation, (mesh::Vec3d{11, -33, 22}));
}

TEST(UpAxis, OfOtherFormatsStaysAsItIs) {
  for (const auto& [bytes, extension] :
       {std::pair{as_stl_binary(cube()), ".stl"}, {as_obj(cube()), ".obj"}}) {
    for (const mesh::Up up : {mesh::Up::kZ, mesh::Up::kY}) {
      const auto read = mesh::read_source({std::string("a") + extension, bytes, {.up = up}});
      ASSERT_TRUE(read) << to_line(read.error());
      EXPECT_FALSE(read->up.has_value());
      EXPECT_EQ(read->instances[0].assembly_from_mesh.linear, mesh::Affine{}.linear);
    }
  }
}

class UpOfAScene : public testing::Test {
 protected:
  Result<mesh::Scene> read(const std::string& manifest, mesh::Up up = mesh::Up::kZ) {
    write_file(folder_ / "a.glb", two_cubes());
    mesh::SceneReading reading;
    reading.up = up;
    return mesh::read_scene(std::vector{write_file(folder_ / "scene.json", manifest)}, std::nullopt,
                            reading);
  }
  static mesh::Vec3d place(const mesh::Scene& scene, std::size_t object) {
    return scene.objects[object].world_from_mesh.translation;
  }
  ScratchFolder folder_;
};

TEST_F(UpOfAScene, IsThatOfTheCommandUnlessAPartStatesItsOwn) {
  const std::string plain = R"({"parts":[{"mesh":"a.glb#a"}]})";
  EXPECT_EQ(place(read(plain).value(), 0), (mesh::Vec3d{11, -33, 22}));
  EXPECT_EQ(place(read(plain, mesh::Up::kY).value(), 0), (mesh::Vec3d{11, 22, 33}));
  const std::string own = R"({"parts":[{"mesh":"a.glb#a","up":"y","translation":[0,0,"1m"]}]})";
  EXPECT_EQ(place(read(own).value(), 0), (mesh::Vec3d{11, 22, 34}));
  const std::string turned = R"({"parts":[{"mesh":"a.glb#a","up":"z"}]})";
  EXPECT_EQ(place(read(turned, mesh::Up::kY).value(), 0), (mesh::Vec3d{11, -33, 22}));
}

TEST_F(UpOfAScene, IsRefusedWhereItIsNoAxisOrTwo) {
  const auto odd = read(R"({"parts":[{"mesh":"a.glb","up":"x"}]})");
  ASSERT_FALSE(odd);
  EXPECT_NE(to_line(odd.error()).find("parts[0].up: is neither \"y\" nor \"z\""), std::string::npos)
      << to_line(odd.error());
  const auto two = read(R"({"parts":[{"mesh":"a.glb#a","up":"y"},{"mesh":"a.glb#b"}]})");
  ASSERT_FALSE(two);
  EXPECT_NE(to_line(two.error()).find("parts[1] of"), std::string::npos) << to_line(two.error());
}

// Files of versions that kept the axes of glTF say nothing.
TEST(UpAxis, IsStatedByBakedFiles) {
  EXPECT_EQ(command::up_in(R"({"tool":"x","up":"z","parts":[{"up":"y"}]})"), "z");
  EXPECT_EQ(command::up_in(R"({"parts":[{"up":"z"}]})"), "");
  EXPECT_EQ(command::up_in(R"({"up":["z"]})"), "");
  EXPECT_EQ(command::up_in("no json"), "");
  EXPECT_EQ(mesh::up_named("z"), mesh::Up::kZ);
  EXPECT_EQ(mesh::up_named("y"), mesh::Up::kY);
  EXPECT_EQ(mesh::up_named(""), mesh::Up::kY);
}

}  // namespace
}  // namespace forcelayer

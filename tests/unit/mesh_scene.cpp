// Scenes of several nodes of one file.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "formats/mesh/scene.h"
#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

using namespace test;

constexpr const char* kNodes =
    R"([{"name":"top","children":[1,2,3,4]},{"name":"a","mesh":0},{"name":"b","children":[5]},)"
    R"({"name":"c","mesh":0,"translation":[5,0,0]},{"name":"d","mesh":0},{"name":"leaf","mesh":0}])";

class SceneOfNodes : public testing::Test {
 protected:
  void SetUp() override {
    write_file(path_, as_glb(gltf_json(cube(), kNodes), gltf_binary(cube())));
    reading_.read = [&](const std::string& path, const mesh::ReadOptions& options) {
      ++reads_[path];
      nodes_ = options.nodes;
      return mesh::read_assembly(path, options);
    };
  }

  std::vector<std::string> names(const std::vector<std::string>& inputs) {
    reads_.clear();
    const auto scene = mesh::read_scene(inputs, std::nullopt, reading_);
    if (!scene) return {to_line(scene.error())};
    std::vector<std::string> names;
    for (const mesh::MeshObject& object : scene->objects) names.push_back(object.name);
    return names;
  }

  ScratchFolder folder_;
  std::string path_ = folder_ / "file.glb";
  mesh::SceneReading reading_;
  std::map<std::string, int> reads_;
  std::vector<std::string> nodes_;
};

TEST_F(SceneOfNodes, ReadsEachFileOnceForAllItsNodes) {
  using Names = std::vector<std::string>;
  EXPECT_EQ(names({path_ + "#a", path_ + "#c", path_ + "#b"}),
            (Names{"top/a", "top/c", "top/b/leaf"}));
  EXPECT_EQ(reads_, (std::map<std::string, int>{{path_, 1}}));
  EXPECT_EQ(nodes_, (Names{"a", "c", "b"}));
}

TEST_F(SceneOfNodes, ReadsTheWholeFileWhereOneInputNamesIt) {
  EXPECT_EQ(names({path_ + "#c", path_}).size(), 5u);  // one, and all four
  EXPECT_EQ(reads_, (std::map<std::string, int>{{path_, 1}}));
  EXPECT_TRUE(nodes_.empty());
}

TEST_F(SceneOfNodes, StandWhereTheFileHasThem) {
  const auto scene = mesh::read_scene(std::vector{path_ + "#c"}, std::nullopt, reading_);
  ASSERT_TRUE(scene) << to_line(scene.error());
  ASSERT_EQ(scene->objects.size(), 1u);
  EXPECT_EQ(scene->objects[0].world_from_mesh.translation, (mesh::Vec3d{5, 0, 0}));
  EXPECT_EQ(scene->objects[0].box_m.low[0], mesh::box_of(cube(), {}).low[0] + 5);
}

TEST_F(SceneOfNodes, WithoutSomeOfThem) {
  using Names = std::vector<std::string>;
  reading_.without = {"{a,leaf}"};
  EXPECT_EQ(names({path_}), (Names{"top/c", "top/d"}));
  reading_.without = {"?"};
  EXPECT_EQ(names({path_}),
            Names{path_ + ": --without leaves out all nodes of this file that have a mesh; "
                          "keep at least one node of this file, or leave out the whole file; "
                          "nothing can block the last part of an assembly"});
  reading_.without = {"e"};
  EXPECT_TRUE(names({path_})[0].starts_with(
      "--without: no file has a node called 'e'; the nearest names are: top/a, "));
}

// A file of the whole name comes first; else the first part that is the name of a file.
TEST_F(SceneOfNodes, AreToldFromFilesWithTheSignInTheirNames) {
  const std::string odd = folder_ / "odd#1.glb";
  write_file(odd, as_glb(gltf_json(cube(), kNodes), gltf_binary(cube())));
  EXPECT_EQ(names({odd}).size(), 4u);
  EXPECT_EQ(names({odd + "#c"}), std::vector<std::string>{"top/c"});
}

// Each file twice, the last one by one of its nodes; they are read ahead in another order.
TEST_F(SceneOfNodes, AreReadAheadFileByFile) {
  std::vector<std::string> paths, inputs;
  for (const char* const name : {"c.glb", "a.glb", "b.glb"}) {
    paths.push_back(folder_ / name);
    write_file(paths.back(), as_glb(gltf_json(cube(), kNodes), gltf_binary(cube())));
  }
  inputs = {paths[0], paths[1], paths[0], paths[1], paths[2] + "#a", paths[2] + "#c"};
  std::vector<double> fractions;
  std::vector<std::string> listed;
  reading_.progress = [&](double fraction) { fractions.push_back(fraction); };
  reading_.read_ahead = [&](std::span<const mesh::FileToRead> files) {
    for (const mesh::FileToRead& file : files) listed.push_back(file.path);
    EXPECT_EQ(files.back().options.nodes, (std::vector<std::string>{"a", "c"}));
    for (std::size_t i = files.size(); i > 0; --i) {
      files[i - 1].options.progress({0.5, 0});
      files[i - 1].options.progress({1, 0});
    }
  };
  ASSERT_EQ(names(inputs).size(), 18u);
  EXPECT_EQ(listed, paths);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_NEAR(fractions.front(), 1.0 / 6, 1e-12);
  EXPECT_NEAR(fractions.back(), 1, 1e-12);
  for (const std::string& path : paths) EXPECT_EQ(reads_[path], 1);
}

}  // namespace
}  // namespace forcelayer

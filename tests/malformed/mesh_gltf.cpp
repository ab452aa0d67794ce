// Small damaged glTF files: the error's code, its place and a part of its reason.
#include <gtest/gtest.h>

#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

using namespace test;

void expect_error(const Result<mesh::Assembly>& assembly, ErrorCode code, const std::string& where,
                  const std::string& fragment) {
  ASSERT_FALSE(assembly) << fragment;
  EXPECT_EQ(assembly.error().code, code) << to_line(assembly.error());
  EXPECT_EQ(assembly.error().where, where) << to_line(assembly.error());
  EXPECT_NE(to_line(assembly.error()).find(fragment), std::string::npos)
      << to_line(assembly.error());
}

constexpr ErrorCode kUnreadable = ErrorCode::kMeshUnreadable;
constexpr ErrorCode kIncomplete = ErrorCode::kMeshIncomplete;
constexpr ErrorCode kUnsupported = ErrorCode::kMeshUnsupported;

// A cube's JSON with the first `from` replaced by `to`.
std::string changed(const std::string& from, const std::string& to,
                    const std::string& nodes = R"([{"mesh":0}])") {
  std::string json = gltf_json(cube(), nodes);
  const std::size_t place = json.find(from);
  if (place == std::string::npos) throw std::logic_error("no " + from);
  return json.replace(place, from.size(), to);
}

Result<mesh::Assembly> read_changed(const std::string& from, const std::string& to) {
  return read_bytes(as_glb(changed(from, to), gltf_binary(cube())), ".glb");
}

Result<mesh::Assembly> read_nodes(const std::string& nodes, const std::string& node = "") {
  return read_bytes(as_glb(gltf_json(cube(), nodes), gltf_binary(cube())), ".glb", node);
}

TEST(DamagedGlb, IsRefusedAtItsContainer) {
  const std::string whole = as_glb(cube());
  expect_error(read_bytes(whole.substr(0, 8), ".glb"), kIncomplete, "byte 8", "GLB header");
  expect_error(read_bytes(whole + "x", ".glb"), kIncomplete, "byte " + std::to_string(whole.size()),
               "announces");
  std::string version = whole;
  version[4] = 1;
  expect_error(read_bytes(version, ".glb"), kUnsupported, "byte 4", "version 1");
  std::string chunk = whole;
  chunk[14] = 0x7f;
  expect_error(read_bytes(chunk, ".glb"), kIncomplete, "byte 12", "longer than the file");
  std::string type = whole;
  type[16] = 'X';
  expect_error(read_bytes(type, ".glb"), kUnreadable, "byte 12", "not JSON");
}

TEST(DamagedGltf, IsRefusedAtItsJson) {
  expect_error(read_bytes("{", ".gltf"), kUnreadable, "JSON byte 2", "not valid JSON");
  expect_error(read_bytes("[]", ".gltf"), kUnreadable, "JSON", "object");
  expect_error(read_bytes("{}", ".gltf"), kUnreadable, "asset", "missing");
  expect_error(read_changed(R"("version":"2.0")", R"("version":"1.0")"), kUnsupported, "asset",
               "'1.0'");
  expect_error(read_changed(R"("version":"2.0")", R"("version":2)"), kUnreadable, "JSON",
               "must be string");
  expect_error(
      read_changed(R"("nodes":[{)", R"("extensionsRequired":["EXT_of_tomorrow"],"nodes":[{)"),
      kUnsupported, "extensionsRequired", "EXT_of_tomorrow");
  const std::string deep = std::string(100'000, '[');
  expect_error(read_bytes(deep, ".gltf"), kUnreadable, "JSON byte 100001", "not valid JSON");
}

TEST(DamagedGltf, NamesTheElementThatIsMissing) {
  expect_error(read_changed(R"({"mesh":0})", R"({"mesh":1})"), kUnreadable, "meshes[1]",
               "does not exist (length of the list: 1)");
  expect_error(read_changed(R"("POSITION":0)", R"("POSITION":2)"), kUnreadable, "accessors[2]",
               "does not exist");
  expect_error(read_changed(R"("POSITION":0)", R"("NORMAL":0)"), kUnreadable,
               "meshes[0].primitives[0]", "no POSITION");
  expect_error(read_changed(R"("bufferView":1)", R"("bufferView":7)"), kUnreadable,
               "bufferViews[7]", "does not exist");
  expect_error(read_changed(R"({"buffer":0)", R"({"buffer":3)"), kUnreadable, "bufferViews[0]",
               "buffer that does not exist");
  expect_error(read_changed(R"("scene":0)", R"("scene":4)"), kUnreadable, "scenes[4]",
               "does not exist");
  expect_error(read_changed(R"("indices":1)", R"("indices":-1)"), kUnreadable, "indices",
               "not a whole number");
  expect_error(read_changed(R"("indices":1)", R"("indices":1,"mode":9)"), kUnreadable,
               "meshes[0].primitives[0]", "unknown mode");
  expect_error(read_changed(R"("primitives":[{)", R"("primitives":[7,{)"), kUnreadable,
               "meshes[0].primitives[0]", "POSITION");
}

TEST(DamagedGltf, ChecksCountsAgainstTheBytes) {
  expect_error(read_changed(R"("count":8)", R"("count":9)"), kIncomplete, "accessors[0]",
               "but its buffer view is too small");
  expect_error(read_changed(R"("count":8)", R"("count":18446744073709551615)"), kIncomplete,
               "accessors[0]", "but its buffer view is too small");
  expect_error(read_changed(R"("bufferView":0,)", ""), kIncomplete, "accessors[0]", "without data");
  const std::string sparse = R"("sparse":{"count":0},"count":4000000000})";
  expect_error(read_changed(R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":8})",
                            R"({"componentType":5126,"type":"VEC3",)" + sparse),
               kIncomplete, "accessors[0]", "without data");
  expect_error(read_changed(R"("byteOffset":96)", R"("byteOffset":97)"), kIncomplete,
               "bufferViews[1]", "beyond its buffer");
  expect_error(read_changed(R"("buffers":[{"byteLength":240})", R"("buffers":[{"byteLength":999})"),
               kIncomplete, "buffers[0]", "announces 999 bytes");
  expect_error(read_changed(R"("byteLength":96})", R"("byteLength":96,"byteStride":4})"),
               kUnreadable, "accessors[0]", "overlap");
  expect_error(read_changed(R"("count":36)", R"("count":35)"), kIncomplete,
               "meshes[0].primitives[0]", "35 corners do not make a whole number");
  expect_error(read_changed(R"("type":"VEC3")", R"("type":"VEC2")"), kUnreadable, "accessors[0]",
               "2 components instead of 3");
  expect_error(read_changed(R"("componentType":5125)", R"("componentType":5126)"), kUnreadable,
               "accessors[1]", "must be a list of vertex numbers");
  expect_error(read_changed(R"("componentType":5125)", R"("componentType":5130)"), kUnreadable,
               "accessors[1]", "unknown type");
}

TEST(DamagedGltf, NamesTheVertexAndTheIndex) {
  mesh::Mesh mesh = cube();
  mesh.vertices[3][1] = std::numeric_limits<double>::quiet_NaN();
  expect_error(read_bytes(as_glb(mesh), ".glb"), kUnreadable, "meshes[0] vertex 3", "finite");
  mesh = cube();
  mesh.triangles[1][2] = 8;
  expect_error(read_bytes(as_glb(mesh), ".glb"), kUnreadable, "meshes[0].primitives[0]",
               "index 5 names vertex 8, but there are only 8 vertices");
}

TEST(DamagedGltf, RefusesTreesThatAreNone) {
  expect_error(read_nodes(R"([{"children":[1]},{"children":[0],"mesh":0}])"), kUnreadable,
               "scenes[0]", "has a parent");
  expect_error(read_nodes(R"([{"children":[1,1]},{"mesh":0}])"), kUnreadable, "nodes[1]",
               "two parents");
  expect_error(read_nodes(R"([{"children":[5]}])"), kUnreadable, "nodes[5]", "does not exist");
  std::string chain = "[";
  for (int i = 1; i < 2000; ++i) chain += R"({"children":[)" + std::to_string(i) + "]},";
  expect_error(read_nodes(chain + R"({"mesh":0}])"), kUnsupported, "nodes[1001]", "nested deeper");
  expect_error(read_changed(R"("nodes":[0])", R"("nodes":[0,0])"), kUnreadable, "scenes[0]",
               "twice");
}

TEST(DamagedGltf, RefusesTransformsThatAreNone) {
  expect_error(read_nodes(R"([{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0]}])"), kUnreadable,
               "nodes[0]", "matrix does not have 16 numbers");
  expect_error(read_nodes(R"([{"mesh":0,"matrix":[1,0,0,0.5,0,1,0,0,0,0,1,0,0,0,0,1]}])"),
               kUnreadable, "nodes[0]", "not affine");
  expect_error(read_nodes(R"([{"mesh":0,"rotation":[0,0,0,0]}])"), kUnreadable, "nodes[0]",
               "not finite");
  expect_error(
      read_nodes(R"([{"children":[1],"scale":[1e300,1,1]},{"mesh":0,"scale":[1e300,1,1]}])"),
      kUnreadable, "nodes[1]", "not finite");
  expect_error(read_nodes(R"([{"mesh":0,"translation":[0,0,"x"]}])"), kUnreadable, "JSON",
               "must be number");
}

TEST(DamagedGltf, SaysWhichNodesThereAre) {
  const std::string nodes = R"([{"name":"root","children":[1,2]},{"name":"a","mesh":0},
                                {"name":"b","children":[3]},{"name":"a","mesh":0}])";
  expect_error(read_nodes(nodes, "c"), ErrorCode::kSceneInvalid, "#c",
               "no node has this name; the nearest names are: root/a, root/b, root/b/a, root");
  expect_error(read_nodes(nodes, "a"), ErrorCode::kSceneInvalid, "#a",
               "several nodes have this name; use one of: root/a, root/b/a");
}

// The paths of many nodes below many long names are the product of both: 300 MB for a file of 1 MB.
TEST(DamagedGltf, IsRefusedWhereItsPathsGrowBeyondIt) {
  const std::string name(1000, 'n');
  std::string nodes = "[", leaves;
  for (int i = 1; i < 900; ++i) {
    nodes += R"({"name":")" + name + R"(","children":[)" + std::to_string(i) + "]},";
  }
  nodes += R"({"children":[900)";
  for (int i = 901; i < 1200; ++i) nodes += "," + std::to_string(i);
  nodes += "]}";
  for (int i = 900; i < 1200; ++i) nodes += R"(,{"mesh":0})";
  const auto assembly = read_nodes(nodes + "]");
  ASSERT_FALSE(assembly);
  EXPECT_EQ(assembly.error().code, kUnsupported);
  EXPECT_NE(assembly.error().what.find("a file of this size"), std::string::npos);
}

// 600,000 elements of one array, to whose parent a parser must not go back for each of them: with
// the square of them this would take minutes.
TEST(DamagedGltf, LongArraysAreReadInTheirOwnTime) {
  std::string nodes = R"([{"mesh":0})";
  for (int i = 1; i < 600'000; ++i) nodes += ",{}";
  EXPECT_TRUE(read_nodes(nodes + "]"));
}

// A parser keeps one of two values, and drops the faces of the other.
TEST(DamagedGltf, SaysWhichKeyStandsTwice) {
  expect_error(read_changed(R"("nodes":)", R"("nodes":[{"mesh":0}],"nodes":)"), kUnreadable, "JSON",
               "the key 'nodes' twice");
  expect_error(read_changed(R"("indices":1)", R"("indices":1,"indices":1)"), kUnreadable, "JSON",
               "the key 'indices' twice");
}

TEST(DamagedGltf, WithoutTrianglesIsEmpty) {
  expect_error(read_nodes(R"([{"name":"nothing"}])"), ErrorCode::kMeshEmpty, "", "no node");
  expect_error(read_changed(R"("indices":1)", R"("mode":0)"), ErrorCode::kMeshEmpty, "",
               "only points or lines");
}

TEST(DamagedGltf, NamesTheBufferThatIsMissing) {
  const auto with_uri = [](const std::string& uri) {
    return read_bytes(changed(R"("buffers":[{)", R"("buffers":[{"uri":")" + uri + R"(",)"),
                      ".gltf");
  };
  const auto missing = with_uri("nothing.bin");
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kFileNotFound);
  EXPECT_NE(missing.error().file.find("nothing.bin"), std::string::npos);
  EXPECT_TRUE(missing.error().where.starts_with("buffers[0] of ")) << missing.error().where;
  EXPECT_TRUE(missing.error().where.ends_with(".gltf")) << missing.error().where;
  expect_error(with_uri("https://example.org/a.bin"), kUnsupported, "buffers[0]", "local file");
  expect_error(with_uri("data:;base64,!!!!"), kUnreadable, "buffers[0]", "not valid base64");
  expect_error(with_uri("data:;base64,AAAA"), kIncomplete, "buffers[0]", "has 3");
  expect_error(read_bytes(gltf_json(cube()), ".gltf"), kIncomplete, "buffers[0]", "has 0");
}

}  // namespace
}  // namespace forcelayer

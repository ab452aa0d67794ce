// Legal glTF files are read: containers, node trees, accessors, primitives.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

using namespace test;

mesh::Assembly read_nodes(const std::string& nodes, const std::string& node = "",
                          const std::string& more = "") {
  const mesh::Mesh mesh = cube();
  const auto assembly =
      read_bytes(as_glb(gltf_json(mesh, nodes, more), gltf_binary(mesh)), ".glb", node);
  EXPECT_TRUE(assembly) << to_line(assembly.error());
  return assembly ? *assembly : mesh::Assembly{};
}

std::vector<std::string> names_of(const mesh::Assembly& assembly) {
  std::vector<std::string> names;
  for (const mesh::MeshInstance& instance : assembly.instances) names.push_back(instance.name);
  return names;
}

mesh::Vec3d origin_of(const mesh::Assembly& assembly, std::size_t instance) {
  return assembly.instances[instance].assembly_from_mesh.translation;
}

void expect_near(const mesh::Vec3d& a, const mesh::Vec3d& b) {
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-12);  // a few roundings
}

TEST(GltfReader, SharesOneMeshBetweenNodes) {
  const mesh::Assembly assembly = read_nodes(
      R"([{"name":"frame","children":[1,2],"translation":[1,0,0]},{"name":"left","mesh":0},
          {"name":"right","mesh":0,"translation":[0,5,0]}])");
  ASSERT_EQ(assembly.meshes.size(), 1u);
  EXPECT_EQ(names_of(assembly), (std::vector<std::string>{"frame/left", "frame/right"}));
  EXPECT_EQ(origin_of(assembly, 0), (mesh::Vec3d{1, 0, 0}));
  EXPECT_EQ(origin_of(assembly, 1), (mesh::Vec3d{1, 5, 0}));
  EXPECT_EQ(assembly.triangle_count(), 24u);
  EXPECT_EQ(assembly.meters_per_unit, 1.0);
  EXPECT_TRUE(assembly.warnings.empty());
}

// A quarter turn about z (written with the rounding that files have), then a stretch.
TEST(GltfReader, ComposesTranslationRotationScaleAsTheMatrixDoes) {
  const mesh::Assembly parts = read_nodes(R"([{"mesh":0,"translation":[1,2,3],
      "rotation":[0,0,0.70710677,0.70710677],"scale":[2,3,-4]}])");
  const mesh::Assembly matrix =
      read_nodes(R"([{"mesh":0,"matrix":[0,2,0,0, -3,0,0,0, 0,0,-4,0, 1,2,3,1]}])");
  const Corners a = corners_of(parts), b = corners_of(matrix);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t corner = 0; corner < 3; ++corner) expect_near(a[i][corner], b[i][corner]);
  }
  const mesh::Affine& placing = matrix.instances[0].assembly_from_mesh;
  const mesh::Vec3d corner{1, 1, 1};
  EXPECT_EQ(mesh::apply(placing, corner), (mesh::Vec3d{-2, 4, -1}));
}

TEST(GltfReader, TellsSiblingsOfOneNameApart) {
  const std::string nodes = R"([{"name":"row","children":[1,2,3,4]},{"name":"bolt","mesh":0},
      {"name":"bolt","mesh":0},{"mesh":0},{"name":"bolt[2]","mesh":0}])";
  EXPECT_EQ(names_of(read_nodes(nodes)),
            (std::vector<std::string>{"row/bolt", "row/bolt[2]", "row/node3", "row/bolt[2][2]"}));
}

TEST(GltfReader, SelectsASubTreeWhereItStands) {
  const std::string nodes = R"([{"name":"plane","children":[1,4],"translation":[1,0,0]},
      {"name":"wing","children":[2,3],"translation":[0,1,0]},{"name":"rib","mesh":0},
      {"name":"spar","mesh":0},{"name":"tail","children":[5]},{"name":"rib","mesh":0}])";
  EXPECT_EQ(names_of(read_nodes(nodes, "wing")),
            (std::vector<std::string>{"plane/wing/rib", "plane/wing/spar"}));
  EXPECT_EQ(origin_of(read_nodes(nodes, "wing"), 0), (mesh::Vec3d{1, 1, 0}));
  EXPECT_EQ(names_of(read_nodes(nodes, "spar")), (std::vector<std::string>{"plane/wing/spar"}));
  EXPECT_EQ(names_of(read_nodes(nodes, "plane/tail/rib")),
            (std::vector<std::string>{"plane/tail/rib"}));
  EXPECT_EQ(read_nodes(nodes, "plane").instances.size(), 3u);
}

TEST(GltfReader, ReadsTheDefaultSceneAndSaysWhatItLeavesOut) {
  const mesh::Mesh mesh = cube();
  std::string json = gltf_json(mesh, R"([{"mesh":0},{"mesh":1}])");
  json.replace(json.find("\"meshes\":["), 10,
               R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]},)");
  const auto assembly = read_bytes(as_glb(json, gltf_binary(mesh)), ".glb");
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  EXPECT_EQ(assembly->instances.size(), 1u);
  ASSERT_EQ(assembly->warnings.size(), 1u);
  EXPECT_NE(assembly->warnings[0].find("1 of 2 meshes are left out"), std::string::npos);
}

TEST(GltfReader, TakesAllRootsWhereThereIsNoScene) {
  const mesh::Mesh mesh = cube();
  std::string json = gltf_json(mesh, R"([{"children":[1]},{"mesh":0},{"mesh":0}])");
  const std::string scene = R"("scene":0,"scenes":[{"nodes":[0]}],)";
  json.erase(json.find(scene), scene.size());
  EXPECT_EQ(read_bytes(as_glb(json, gltf_binary(mesh)), ".glb")->instances.size(), 2u);
}

// A child of 1.5 was read as 1, one of -1 as 2^64 - 1, and one of 80 digits undefined.
TEST(GltfReader, RefusesNodesThatAreNoWholeNumbers) {
  const mesh::Mesh mesh = cube();
  for (const std::string& child : {std::string("1.5"), std::string("-1"), std::string(80, '7'),
                                   std::string("\"1\""), std::string("null")}) {
    const std::string json = gltf_json(mesh, R"([{"children":[)" + child + R"(]},{"mesh":0}])");
    const auto read = read_bytes(as_glb(json, gltf_binary(mesh)), ".glb");
    ASSERT_FALSE(read) << child;
    EXPECT_EQ(read.error().what, "is not a whole number of zero or more") << child;
  }
  const std::string json = gltf_json(mesh, R"([{"children":[1.0]},{"mesh":0}])");
  EXPECT_EQ(read_bytes(as_glb(json, gltf_binary(mesh)), ".glb")->instances.size(), 1u);
}

std::string base64(const std::string& bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      bits = bits << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u);
    }
    for (std::size_t j = 0; j < 4; ++j) {
      text += i + j <= bytes.size() ? kDigits[bits >> (18 - 6 * j) & 63] : '=';
    }
  }
  return text;
}

std::string json_with_uri(const mesh::Mesh& mesh, const std::string& uri) {
  std::string json = gltf_json(mesh);
  return json.insert(json.rfind("{\"byteLength\"") + 1, "\"uri\":\"" + uri + "\",");
}

TEST(GltfReader, TakesBuffersFromDataUrisAndFilesBesideIt) {
  const mesh::Mesh mesh = cube();
  const auto inside = read_bytes(
      json_with_uri(mesh, "data:application/octet-stream;base64," + base64(gltf_binary(mesh))),
      ".gltf");
  ASSERT_TRUE(inside) << to_line(inside.error());
  EXPECT_EQ(corners_of(*inside), corners_of(mesh));
  const ScratchFolder folder;
  write_file(folder / "my data.bin", gltf_binary(mesh));
  const auto beside = mesh::read_assembly(
      write_file(folder / "mesh.gltf", json_with_uri(mesh, "my%20data.bin")), {.up = mesh::Up::kY});
  ASSERT_TRUE(beside) << to_line(beside.error());
  EXPECT_EQ(corners_of(*beside), corners_of(mesh));
}

// One primitive over hand-made accessors: `binary` holds what `views` and `accessors` describe.
struct Handmade {
  std::string primitive, accessors, views, binary, more;

  Result<mesh::Assembly> read() const {
    return read_bytes(
        as_glb(R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
               R"("meshes":[{"primitives":[)" +
                   primitive + R"(]}],"accessors":[)" + accessors + R"(],"bufferViews":[)" + views +
                   R"(],"buffers":[{"byteLength":)" + std::to_string(binary.size()) + "}]" + more +
                   "}",
               binary),
        ".glb");
  }
};

const mesh::Vec3d kO{0, 0, 0}, kX{1, 0, 0}, kY{0, 1, 0}, kXY{1, 1, 0}, kZ{0, 0, 1};

// Five positions as floats, and the view and accessor 0 for them.
Handmade five_points(const std::string& primitive) {
  Handmade made;
  made.primitive = primitive;
  for (const mesh::Vec3d& point : {kO, kX, kY, kXY, kZ}) {
    for (const double coordinate : point) put(made.binary, static_cast<float>(coordinate));
  }
  made.views = R"({"buffer":0,"byteLength":60})";
  made.accessors = R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":5})";
  return made;
}

Corners corners_in(const Handmade& made) {
  const auto assembly = made.read();
  EXPECT_TRUE(assembly) << to_line(assembly.error());
  return assembly ? corners_of(*assembly) : Corners{};
}

TEST(GltfReader, TakesStripsFansAndUnindexedTriangles) {
  EXPECT_EQ(corners_in(five_points(R"({"attributes":{"POSITION":0},"mode":5})")),
            (Corners{{kO, kX, kY}, {kX, kXY, kY}, {kY, kXY, kZ}}));
  EXPECT_EQ(corners_in(five_points(R"({"attributes":{"POSITION":0},"mode":6})")),
            (Corners{{kO, kX, kY}, {kO, kY, kXY}, {kO, kXY, kZ}}));
  Handmade plain = five_points(R"({"attributes":{"POSITION":0}})");
  plain.accessors = R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":3})";
  EXPECT_EQ(corners_in(plain), (Corners{{kO, kX, kY}}));
}

TEST(GltfReader, TakesIndicesOfEverySize) {
  for (const int component : {5121, 5123, 5125}) {
    Handmade made = five_points(R"({"attributes":{"POSITION":0},"indices":1})");
    for (const unsigned index : {4u, 0u, 3u}) {
      if (component == 5121) put(made.binary, static_cast<std::uint8_t>(index));
      if (component == 5123) put(made.binary, static_cast<std::uint16_t>(index));
      if (component == 5125) put(made.binary, static_cast<std::uint32_t>(index));
    }
    made.views += R"(,{"buffer":0,"byteOffset":60,"byteLength":)" +
                  std::to_string(made.binary.size() - 60) + "}";
    made.accessors += R"(,{"bufferView":1,"type":"SCALAR","count":3,"componentType":)" +
                      std::to_string(component) + "}";
    EXPECT_EQ(corners_in(made), (Corners{{kZ, kO, kXY}})) << component;
  }
}

TEST(GltfReader, StepsOverInterleavedData) {
  Handmade made;
  made.primitive = R"({"attributes":{"POSITION":0}})";
  for (const mesh::Vec3d& point : {kO, kX, kZ}) {
    put(made.binary, 99.0f);
    for (const double coordinate : point) put(made.binary, static_cast<float>(coordinate));
  }
  made.views = R"({"buffer":0,"byteLength":48,"byteStride":16})";
  made.accessors =
      R"({"bufferView":0,"byteOffset":4,"componentType":5126,"type":"VEC3","count":3})";
  EXPECT_EQ(corners_in(made), (Corners{{kO, kX, kZ}}));
}

TEST(GltfReader, ReplacesTheElementsOfASparseAccessor) {
  Handmade made = five_points(R"({"attributes":{"POSITION":0}})");
  put(made.binary, std::uint16_t{1});
  put(made.binary, std::uint16_t{0});  // padding
  for (const float coordinate : {7.f, 8.f, 9.f}) put(made.binary, coordinate);
  made.views += R"(,{"buffer":0,"byteOffset":60,"byteLength":2},
                    {"buffer":0,"byteOffset":64,"byteLength":12})";
  const std::string sparse = R"("sparse":{"count":1,
      "indices":{"bufferView":1,"componentType":5123},"values":{"bufferView":2}})";
  made.accessors =
      R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":3,)" + sparse + "}";
  EXPECT_EQ(corners_in(made), (Corners{{kO, {7, 8, 9}, kY}}));
  made.accessors = R"({"componentType":5126,"type":"VEC3","count":3,)" + sparse + "}";
  EXPECT_EQ(corners_in(made), (Corners{{kO, {7, 8, 9}, kO}}));
}

TEST(GltfReader, TakesQuantizedPositionsWithAWarning) {
  Handmade made;
  made.primitive = R"({"attributes":{"POSITION":0}})";
  for (const int value : {0, 0, 0, 32767, 0, 0, 0, -32768, 16384}) {
    put(made.binary, static_cast<std::int16_t>(value));
  }
  made.views = R"({"buffer":0,"byteLength":18})";
  made.accessors =
      R"({"bufferView":0,"componentType":5122,"normalized":true,"type":"VEC3","count":3})";
  made.more = R"(,"extensionsRequired":["KHR_mesh_quantization"])";
  EXPECT_EQ(corners_in(made), (Corners{{kO, kX, {0, -1, 16384 / 32767.0}}}));
  ASSERT_EQ(made.read()->warnings.size(), 1u);
  made.accessors = R"({"bufferView":0,"componentType":5122,"type":"VEC3","count":3})";
  EXPECT_EQ(corners_in(made), (Corners{{kO, {32767, 0, 0}, {0, -32768, 16384}}}));
}

TEST(GltfReader, MakesOneMeshOfThePrimitivesOfAMesh) {
  Handmade made = five_points(R"({"attributes":{"POSITION":0},"indices":1},
      {"attributes":{"POSITION":0},"mode":1},{"attributes":{"POSITION":0},"indices":1})");
  for (const unsigned index : {0u, 1u, 2u}) put(made.binary, static_cast<std::uint8_t>(index));
  made.views += R"(,{"buffer":0,"byteOffset":60,"byteLength":3})";
  made.accessors += R"(,{"bufferView":1,"type":"SCALAR","count":3,"componentType":5121})";
  const auto assembly = made.read();
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  ASSERT_EQ(assembly->meshes.size(), 1u);
  EXPECT_EQ(assembly->meshes[0].vertices.size(), 3u);  // of the shared accessor, once
  EXPECT_EQ(assembly->triangle_count(), 2u);
  ASSERT_EQ(assembly->warnings.size(), 1u);
  EXPECT_NE(assembly->warnings[0].find("1 primitive of points or lines"), std::string::npos);
}

TEST(GltfReader, PlacesEveryGpuInstance) {
  Handmade made = five_points(R"({"attributes":{"POSITION":0},"mode":5})");
  for (const float number : {1.f, 0.f, 0.f, 0.f, 2.f, 0.f}) put(made.binary, number);  // moves
  for (const float number : {2.f, 2.f, 2.f, 3.f, 3.f, 3.f}) put(made.binary, number);  // scales
  made.views += R"(,{"buffer":0,"byteOffset":60,"byteLength":48})";
  made.accessors += R"(,{"bufferView":1,"componentType":5126,"type":"VEC3","count":2},
      {"bufferView":1,"byteOffset":24,"componentType":5126,"type":"VEC3","count":2})";
  made.more = R"(,"extensionsRequired":["EXT_mesh_gpu_instancing"])";
  const std::string instancing = R"("mesh":0,"name":"bolts","translation":[10,0,0],
      "extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":1,"SCALE":2}}})";
  std::string json = R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{)" +
                     instancing + R"(}],"meshes":[{"primitives":[)" + made.primitive +
                     R"(]}],"accessors":[)" + made.accessors + R"(],"bufferViews":[)" + made.views +
                     R"(],"buffers":[{"byteLength":)" + std::to_string(made.binary.size()) + "}]" +
                     made.more + "}";
  const auto assembly = read_bytes(as_glb(json, made.binary), ".glb");
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  EXPECT_EQ(names_of(*assembly), (std::vector<std::string>{"bolts/0", "bolts/1"}));
  EXPECT_EQ(mesh::apply(assembly->instances[0].assembly_from_mesh, kX), (mesh::Vec3d{13, 0, 0}));
  EXPECT_EQ(mesh::apply(assembly->instances[1].assembly_from_mesh, kX), (mesh::Vec3d{13, 2, 0}));
}

// Accessor 1 of these five points moves the second by (0, 0, 4).
Handmade morphing_points(const std::string& more_of_mesh) {
  Handmade made =
      five_points(R"({"attributes":{"POSITION":0},"mode":6,"targets":[{},{"POSITION":1}]}])" +
                  more_of_mesh + R"(,"extras":[0)");  // read() closes it
  for (int n = 0; n < 15; ++n) put(made.binary, n == 5 ? 4.0f : 0.0f);
  made.views += R"(,{"buffer":0,"byteOffset":60,"byteLength":60})";
  made.accessors += R"(,{"bufferView":1,"componentType":5126,"type":"VEC3","count":5})";
  return made;
}

TEST(GltfReader, CountsTheNodesThatAreHidden) {
  const std::string hidden = R"("extensions":{"KHR_node_visibility":{"visible":false}})";
  const auto warnings = [&](const std::string& top, const std::string& leaf) {
    return read_nodes(R"([{"name":"top","children":[1,2])" + top + R"(},{"name":"a","mesh":0)" +
                      leaf + R"(},{"name":"b","mesh":0}])")
        .warnings;
  };
  using Lines = std::vector<std::string>;
  EXPECT_EQ(warnings("", ""), Lines{});
  EXPECT_EQ(warnings("", "," + hidden),
            Lines{"the file hides the mesh of 1 node, but hidden meshes are read, too"});
  EXPECT_EQ(warnings("," + hidden, ""),
            Lines{"the file hides the meshes of 2 nodes, but hidden meshes are read, too"});
  EXPECT_EQ(warnings("," + hidden, "," + hidden),
            Lines{"the file hides the meshes of 2 nodes, but hidden meshes are read, too"});
}

TEST(GltfReader, TellsNodesThatTheDefaultSceneDoesNotHold) {
  const mesh::Mesh mesh = test::cube();
  const auto read = [&](const std::string& nodes) {
    const std::string bytes = as_glb(gltf_json(mesh, nodes), gltf_binary(mesh));
    return mesh::read_source({"mesh.glb", bytes, {}});
  };
  const auto elsewhere = read(R"([{"mesh":0},{"mesh":0},{"name":"camera"}])");
  ASSERT_TRUE(elsewhere) << to_line(elsewhere.error());
  EXPECT_EQ(elsewhere->instances.size(), 1u);
  EXPECT_EQ(elsewhere->warnings,
            (std::vector<std::string>{
                "1 node with a mesh is left out: the default scene does not contain it"}));
  EXPECT_TRUE(read(R"([{"mesh":0}])")->warnings.empty());
}

TEST(GltfReader, AppliesTheDefaultWeightsOfMorphTargets) {
  EXPECT_EQ(corners_in(morphing_points("")), (Corners{{kO, kX, kY}, {kO, kY, kXY}, {kO, kXY, kZ}}));
  const Handmade morphed = morphing_points(R"(,"weights":[0.5,0.25])");
  EXPECT_EQ(corners_in(morphed), (Corners{{kO, {1, 0, 1}, kY}, {kO, kY, kXY}, {kO, kXY, kZ}}));
  EXPECT_EQ(morphed.read()->warnings,
            (std::vector<std::string>{
                "node0: morph targets are applied with their default weights 0.5, 0.25"}));
  EXPECT_EQ(morphing_points(R"(,"weights":[0,0])").read()->warnings,
            (std::vector<std::string>{
                "node0: morph targets are left out: their default weights are zero"}));
}

// A node may have weights of its own: then the mesh stands there in another shape.
TEST(GltfReader, TakesTheWeightsOfANodeBeforeThoseOfItsMesh) {
  const Handmade made = morphing_points(R"(,"weights":[0,1])");
  const std::string json =
      R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0,1]}],)"
      R"("nodes":[{"mesh":0},{"mesh":0,"weights":[0,0.5]}],"meshes":[{"primitives":[)" +
      made.primitive + R"(]}],"accessors":[)" + made.accessors + R"(],"bufferViews":[)" +
      made.views + R"(],"buffers":[{"byteLength":)" + std::to_string(made.binary.size()) + "}]}";
  const auto assembly = read_bytes(as_glb(json, made.binary), ".glb");
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  ASSERT_EQ(assembly->meshes.size(), 2u);
  EXPECT_EQ(assembly->meshes[0].vertices[1], (mesh::Vec3d{1, 0, 4}));
  EXPECT_EQ(assembly->meshes[1].vertices[1], (mesh::Vec3d{1, 0, 2}));
  EXPECT_EQ(assembly->warnings,
            (std::vector<std::string>{
                "node0: morph targets are applied with their default weights 0, 1",
                "node1: morph targets are applied with their default weights 0, 0.5"}));
}

TEST(GltfReader, NamesTheNodesThatAScaleMakesFlat) {
  const mesh::Assembly flat = read_nodes(R"([{"name":"lid","mesh":0,"scale":[1,0,1]}])");
  EXPECT_EQ(flat.warnings,
            (std::vector<std::string>{"lid: a scale of 0 makes the mesh flat or a point; to leave "
                                      "the mesh out, use --without"}));
  EXPECT_TRUE(read_nodes(R"([{"name":"lid","mesh":0,"scale":[1,-1e-6,1]}])").warnings.empty());
}

// glTF has it that the transform of a skinned node does not count.
TEST(GltfReader, JointsPlaceASkinnedNode) {
  const std::string nodes =
      R"([{"name":"man","children":[1,2]},{"name":"arm","mesh":0,"skin":0,"translation":[100,0,0]},
          {"name":"hip","translation":[0,7,0],"children":[3]},{"name":"knee"}])";
  const mesh::Assembly skinned = read_nodes(nodes, "", R"(,"skins":[{"joints":[2,3]}])");
  ASSERT_EQ(skinned.instances.size(), 1u);
  EXPECT_EQ(origin_of(skinned, 0), (mesh::Vec3d{0, 7, 0}));
  ASSERT_EQ(skinned.warnings.size(), 1u);
  EXPECT_EQ(skinned.warnings[0].find("man/arm: the skin places the mesh in the bind pose"), 0u);
  const auto refused = [](const std::string& more) {
    const mesh::Mesh mesh = cube();
    const std::string json = gltf_json(
        mesh, R"([{"mesh":0,"skin":0,"children":[1]},{"children":[2]},{"translation":[0,0,0.1]}])",
        more);
    const auto read = read_bytes(as_glb(json, gltf_binary(mesh)), ".glb");
    return read ? std::string() : to_line(read.error());
  };
  EXPECT_NE(refused(R"(,"skins":[{"joints":[1,2]}])").find("skins[0]: is posed"),
            std::string::npos);
  EXPECT_NE(refused(R"(,"skins":[{"joints":[]}])").find("no joints"), std::string::npos);
  EXPECT_NE(refused("").find("skins[0]"), std::string::npos);
  EXPECT_EQ(refused(R"(,"skins":[{"joints":[2]}])"), "");
}

// The inverse of a joint's place, as exporters write it, leaves the mesh where it was bound.
TEST(GltfReader, InverseBindMatricesTakeTheMeshToItsJoints) {
  Handmade made = five_points(R"({"attributes":{"POSITION":0},"mode":5})");
  for (const float z : {-3.f, -4.f}) {
    for (int n = 0; n < 16; ++n) put(made.binary, n % 5 == 0 ? 1.f : n == 14 ? z : 0.f);
  }
  const std::string json =
      R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0,"skin":0,"translation":[9,9,9]},
          {"translation":[0,0,3],"children":[2]},{"translation":[0,0,1]}],
          "skins":[{"joints":[1,2],"inverseBindMatrices":1}],"meshes":[{"primitives":[)" +
      made.primitive + R"(]}],"accessors":[)" + made.accessors +
      R"(,{"bufferView":1,"componentType":5126,"type":"MAT4","count":2}],"bufferViews":[)" +
      made.views + R"(,{"buffer":0,"byteOffset":60,"byteLength":128}],"buffers":[{"byteLength":)" +
      std::to_string(made.binary.size()) + "}]}";
  const auto assembly = read_bytes(as_glb(json, made.binary), ".glb");
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  EXPECT_EQ(origin_of(*assembly, 0), (mesh::Vec3d{0, 0, 0}));
}

// Attributes that move nothing say how many instances there are; without any nothing does.
TEST(GltfReader, CountsInstancesThatNothingMoves) {
  const std::string node = R"([{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":)";
  EXPECT_EQ(read_nodes(node + R"({"_ID":0}}}}])").instances.size(), 8u);  // the cube's vertices
  const mesh::Mesh mesh = cube();
  for (const std::string attributes : {R"({})", R"({"TRANSLATION":0,"_ID":1})"}) {
    const auto read =
        read_bytes(as_glb(gltf_json(mesh, node + attributes + "}}}]"), gltf_binary(mesh)), ".glb");
    ASSERT_FALSE(read) << attributes;
    EXPECT_EQ(read.error().where, "EXT_mesh_gpu_instancing");
  }
}

}  // namespace
}  // namespace forcelayer

// A file of a hundred bytes or so that announces immense counts is refused, or read, in 64 MiB:
// counts are held against the file before memory is taken.
#include <gtest/gtest.h>

#include "formats/mesh/scene_manifest.h"
#include "tests/support/address_limit.h"
#include "tests/support/draco_files.h"
#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

using namespace test;
using namespace std::string_literals;

constexpr std::uint64_t kEnoughBytes = std::uint64_t{64} << 20;

struct Announcement {
  const char* name;
  const char* extension;
  std::string bytes;
};

template <class T>
std::string little(T number) {
  return {reinterpret_cast<const char*>(&number), sizeof number};
}

std::string ply(const std::string& format, const std::string& counts) {
  return "ply\nformat " + format + " 1.0\n" + counts + "end_header\n0 0 0\n";
}

std::string gltf(const std::string& rest) { return R"({"asset":{"version":"2.0"},)" + rest + "}"; }

std::vector<Announcement> announcements() {
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  std::vector<Announcement> all = {
      {"StlCount", ".stl", std::string(80, ' ') + little(0xffffffffu)},
      {"StlCountWithSomeBytes", ".stl",
       std::string(80, ' ') + little(0xfffffff0u) + std::string(50, '\0')},
      {"OffVertices", ".off", "OFF\n4294967295 1 0\n0 0 0\n"},
      {"OffFaces", ".off", "OFF\n3 18446744073709551615 0\n0 0 0 1 0 0 0 1 0\n"},
      {"OffCorners", ".off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4000000000 0 1 2\n"},
      {"PlyVertices", ".ply", ply("ascii", "element vertex 4000000000\n" + xyz)},
      {"PlyVerticesLittle", ".ply",
       ply("binary_little_endian", "element vertex 4294967295\n" + xyz)},
      {"PlyVerticesBig", ".ply",
       ply("binary_big_endian", "element vertex 18446744073709551615\n" + xyz)},
      {"PlyOtherElement", ".ply", ply("binary_little_endian", "element dust 9999999999\n")},
      {"PlyNoProperties", ".ply",
       ply("binary_little_endian", "element dust 4000000000\nelement vertex 4000000000\n")},
      {"PlyList", ".ply",
       ply("binary_little_endian",
           "element vertex 0\n" + xyz + "element face 1\nproperty list uint int vertex_indices\n") +
           little(0xffffffffu)},
      {"PlyStrips", ".ply",
       ply("ascii", "element vertex 0\n" + xyz +
                        "element tristrips 1\nproperty list int int vertex_indices\n") +
           "2147483647 0 1 2\n"},
      {"ObjIndex", ".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4294967295\nf 1 2 -2147483648\n"},
      {"GlbLength", ".glb", "glTF" + little(2u) + little(0xffffffffu)},
      {"GlbChunk", ".glb",
       "glTF" + little(2u) + little(20u) + little(0xfffffff0u) + little(0x4e4f534au)},
      {"GltfBuffer", ".gltf", gltf(R"("buffers":[{"byteLength":4000000000}])")},
      {"GltfAccessor", ".gltf",
       gltf(R"("accessors":[{"count":4000000000,"componentType":5126,"type":"VEC3",)"
            R"("sparse":{"count":1}}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
            R"("nodes":[{"mesh":0}])")},
      {"GltfAccessorOverflow", ".gltf",
       gltf(R"("accessors":[{"count":6148914691236517206,"componentType":5126,"type":"VEC3",)"
            R"("bufferView":0}],"bufferViews":[{"buffer":0,"byteLength":3,"byteStride":12}],)"
            R"("buffers":[{"byteLength":3,"uri":"data:;base64,AAAA"}],)"
            R"("meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}])")},
      {"GltfNesting", ".gltf", std::string(100, '[')},
      {"Om", ".om", "OM\x02\x31"s + little(0xffffffffu) + std::string(64, '\xff')},
      {"OmOld", ".om", "OM\x12\x00"s + std::string(64, '\x7f')},
  };
  // Draco: every byte of a small stream's head turned into the largest count.
  for (const bool edgebreaker : {false, true}) {
    const std::string whole = as_drc(cube(), {.position_bits = 10, .edgebreaker = edgebreaker});
    for (std::size_t at = 9; at < 24; ++at) {
      std::string bytes = whole.substr(0, at) + "\xff\xff\xff\xff\x0f" + whole.substr(at + 1);
      bytes.resize(std::min<std::size_t>(bytes.size(), 100));
      all.push_back({edgebreaker ? "DracoEdgebreaker" : "DracoSequential", ".drc", bytes});
    }
  }
  return all;
}

TEST(SmallFiles, CannotAskForMemory) {
  for (const Announcement& file : announcements()) {
    SCOPED_TRACE(file.name + (" of " + std::to_string(file.bytes.size())) + " bytes");
    const bool draco = std::string_view(file.extension) == ".drc";
    const AddressLimit limit(draco ? 8 * kEnoughBytes : kEnoughBytes);  // 10^4 faces a byte
    const auto read = read_bytes(file.bytes, file.extension);
    if (draco && read) continue;
    ASSERT_FALSE(read);
    EXPECT_NE(read.error().code, ErrorCode::kOutOfMemory) << to_line(read.error());
    EXPECT_EQ(exit_status(read.error().code), 3) << to_line(read.error());
  }
}

// Files in which many things share one: what they unfold to is bounded by the file's size.
TEST(SmallFiles, SharingIsNoWayAround) {
  // 3000 nodes, each with the same 3000 instances; and 2000 meshes of the same 20000 vertices.
  std::string nodes, meshes, mesh_nodes, roots;
  for (int i = 0; i < 3000; ++i) {
    const std::string comma = i == 0 ? "" : ",", number = std::to_string(i);
    nodes += comma + R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":)"
                     R"({"TRANSLATION":1}}}})";
    meshes += comma + R"({"primitives":[{"attributes":{"POSITION":0},"mode":5}]})";
    mesh_nodes += comma + R"({"mesh":)" + number + "}";
  }
  const std::string buffer = R"("buffers":[{"byteLength":240000,"uri":"data:;base64,)" +
                             std::string(320000, 'A') + R"("}],"bufferViews":[{"buffer":0,)" +
                             R"("byteLength":240000}],)";
  const auto accessors = [](int vertices, int instances) {
    const auto accessor = [](int count) {
      return R"({"bufferView":0,"componentType":5126,"type":"VEC3","count":)" +
             std::to_string(count) + "}";
    };
    return R"("accessors":[)" + accessor(vertices) + "," + accessor(instances) + "],";
  };
  const auto instanced =
      read_bytes(gltf(buffer + accessors(3, 20000) + R"("meshes":[{"primitives":[{"attributes":)" +
                      R"({"POSITION":0}}]}],"nodes":[)" + nodes + "]"),
                 ".gltf");
  ASSERT_FALSE(instanced);
  EXPECT_EQ(instanced.error().code, ErrorCode::kMeshUnsupported) << to_line(instanced.error());
  const auto shared = read_bytes(gltf(buffer + accessors(20000, 1) + R"("meshes":[)" + meshes +
                                      R"(],"nodes":[)" + mesh_nodes + "]"),
                                 ".gltf");
  ASSERT_FALSE(shared);
  EXPECT_EQ(shared.error().code, ErrorCode::kMeshUnsupported) << to_line(shared.error());
}

TEST(SmallFiles, ManifestsToo) {
  const ScratchFolder folder;
  for (const std::string& text :
       {R"({"layers": 4294967296, "parts": [{"mesh": "a.stl"}]})"s,
        R"({"voxel_size": 1e999, "parts": [{"mesh": "a.stl"}]})"s,
        R"({"voxel_size": 1e308, "roi": [-1e308, 0, 0, 1e308, 1, 1], "parts": []})"s,
        std::string(100000, '['), std::string(100000, '{')}) {
    std::ofstream(folder / "scene.json") << text;
    const AddressLimit limit(kEnoughBytes);
    const auto manifest = mesh::read_manifest((folder / "scene.json").string());
    ASSERT_FALSE(manifest);
    EXPECT_EQ(manifest.error().code, ErrorCode::kSceneInvalid) << to_line(manifest.error());
  }
}

// A parser keeps one of two lists of parts.
TEST(SmallFiles, ManifestsWithAKeyTwiceAreRefused) {
  const ScratchFolder folder;
  std::ofstream(folder / "scene.json")
      << R"({"voxel_size": "1mm", "parts": [{"mesh": "a.stl"}], "parts": [{"mesh": "b.stl"}]})";
  const auto manifest = mesh::read_manifest((folder / "scene.json").string());
  ASSERT_FALSE(manifest);
  EXPECT_EQ(manifest.error().where, "parts");
  EXPECT_EQ(manifest.error().what, "is given twice in the same JSON object");
}

// A floor that is a point is passed everywhere.
TEST(SmallFiles, ManifestsWithAFlatObjectAreRefused) {
  const ScratchFolder folder;
  const auto read = [&](const std::string& pose) {
    std::ofstream(folder / "scene.json") << R"({"parts": [{"mesh": "a.stl", )" + pose + "}]}";
    return mesh::read_manifest((folder / "scene.json").string());
  };
  const std::string turned = R"("rotation": [0.9, 0.1, -0.3, 0.2], )";
  for (const char* const scale : {"0", "-0.0", "[0, 0, 0]", "[1, 0, 1]", "[1e-3, 1e3, 0]"}) {
    for (const std::string& rotation : {std::string(), turned}) {
      const auto flat = read(rotation + R"("scale": )" + scale);
      ASSERT_FALSE(flat) << scale;
      EXPECT_EQ(flat.error().where, "parts[0].scale");
      EXPECT_EQ(flat.error().what, "collapses the object to a plane, a line or a point");
    }
  }
  // The third column is the sum of the others, but for rounding.
  const auto flat = read(
      R"("matrix": [[0.1, 0.2, 0.3, 0], [0.7, 0.1, 0.8, 0], [0.3, 0.5, 0.8, 0], [0, 0, 0, 1]])");
  ASSERT_FALSE(flat);
  EXPECT_EQ(flat.error().where, "parts[0].matrix");
  for (const char* const scale : {"-1", "[1, 1, -1]", "[1e-6, 1, 1e6]", "1e-200", "1e200"}) {
    for (const std::string& rotation : {std::string(), turned}) {
      EXPECT_TRUE(read(rotation + R"("scale": )" + scale)) << scale;
    }
  }
}

}  // namespace
}  // namespace forcelayer

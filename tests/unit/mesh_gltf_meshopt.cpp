// glTF with buffer views that EXT_meshopt_compression packed.
#include <gtest/gtest.h>

#include <random>

#include "formats/mesh/readers/gltf/meshopt_view.h"
#include "tests/support/mesh_files.h"

#ifdef FORCELAYER_MESHOPT
#include <meshoptimizer.h>
#endif

namespace forcelayer {
namespace {

using namespace test;

struct View {
  std::string packed, mode, filter = "NONE";
  std::size_t count, stride;
};

// The cube with these two views, packed behind each other in buffer 0; buffer 1 has no bytes.
std::string packed_glb(const View& positions, const View& indices, const std::string& position_type,
                       const std::string& index_type) {
  std::string binary, views;
  for (const View* view : {&positions, &indices}) {
    if (!views.empty()) views += ",";
    views += R"({"buffer":1,"byteLength":)" + std::to_string(view->count * view->stride) +
             R"(,"byteStride":)" + std::to_string(view->stride) +
             R"(,"extensions":{"EXT_meshopt_compression":{"buffer":0,"byteOffset":)" +
             std::to_string(binary.size()) + R"(,"byteLength":)" +
             std::to_string(view->packed.size()) + R"(,"byteStride":)" +
             std::to_string(view->stride) + R"(,"count":)" + std::to_string(view->count) +
             R"(,"mode":")" + view->mode + R"(","filter":")" + view->filter + R"("}}})";
    binary += view->packed;
  }
  const std::string json =
      R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],)"
      R"("extensionsRequired":["EXT_meshopt_compression","KHR_mesh_quantization"],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],)"
      R"("accessors":[{"bufferView":0,"type":"VEC3",)" +
      position_type + R"("count":)" + std::to_string(positions.count) +
      R"(},{"bufferView":1,"type":"SCALAR",)" + index_type + R"("count":)" +
      std::to_string(indices.count) + R"(}],"bufferViews":[)" + views +
      R"(],"buffers":[{"byteLength":)" + std::to_string(binary.size()) +
      R"(},{"byteLength":100000,"extensions":{"EXT_meshopt_compression":{"fallback":true}}}]})";
  return as_glb(json, binary);
}

const std::string kFloat = R"("componentType":5126,)", kShort = R"("componentType":5122,)",
                  kIndex16 = R"("componentType":5123,)", kIndex32 = R"("componentType":5125,)";

#ifdef FORCELAYER_MESHOPT

template <typename T>
View attributes(const std::vector<T>& values, std::size_t stride, std::string filter = "NONE") {
  View view{"", "ATTRIBUTES", std::move(filter), values.size() * sizeof(T) / stride, stride};
  view.packed.resize(meshopt_encodeVertexBufferBound(view.count, stride));
  auto* packed = reinterpret_cast<unsigned char*>(view.packed.data());
  view.packed.resize(
      meshopt_encodeVertexBuffer(packed, view.packed.size(), values.data(), view.count, stride));
  return view;
}

View triangles(const mesh::Mesh& mesh, std::size_t stride) {
  std::vector<std::uint32_t> corners;
  for (const mesh::Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  View view{"", "TRIANGLES", "NONE", corners.size(), stride};
  view.packed.resize(meshopt_encodeIndexBufferBound(corners.size(), mesh.vertices.size()));
  auto* packed = reinterpret_cast<unsigned char*>(view.packed.data());
  view.packed.resize(
      meshopt_encodeIndexBuffer(packed, view.packed.size(), corners.data(), corners.size()));
  return view;
}

View sequence(const mesh::Mesh& mesh) {
  std::vector<std::uint32_t> corners;
  for (const mesh::Triangle& t : mesh.triangles) corners.insert(corners.end(), t.begin(), t.end());
  View view{"", "INDICES", "NONE", corners.size(), 4};
  view.packed.resize(meshopt_encodeIndexSequenceBound(corners.size(), mesh.vertices.size()));
  auto* packed = reinterpret_cast<unsigned char*>(view.packed.data());
  view.packed.resize(
      meshopt_encodeIndexSequence(packed, view.packed.size(), corners.data(), corners.size()));
  return view;
}

std::vector<float> floats_of(const mesh::Mesh& mesh) {
  std::vector<float> values;
  for (const mesh::Vec3d& v : mesh.vertices) {
    for (const double x : v) values.push_back(static_cast<float>(x));
  }
  return values;
}

Corners sorted_corners(const Result<mesh::Assembly>& assembly) {
  EXPECT_TRUE(assembly) << (assembly ? "" : to_line(assembly.error()));
  if (!assembly) return {};
  Corners corners = corners_of(*assembly);
  for (auto& t : corners) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::sort(corners.begin(), corners.end());
  return corners;
}

Corners plain_corners() { return sorted_corners(read_bytes(as_glb(cube()), ".glb")); }

TEST(GltfMeshopt, IsReadAsItWasBefore) {
  const mesh::Mesh mesh = cube();
  const View positions = attributes(floats_of(mesh), 12);
  EXPECT_EQ(sorted_corners(
                read_bytes(packed_glb(positions, triangles(mesh, 4), kFloat, kIndex32), ".glb")),
            plain_corners());
  EXPECT_EQ(sorted_corners(
                read_bytes(packed_glb(positions, triangles(mesh, 2), kFloat, kIndex16), ".glb")),
            plain_corners());
  EXPECT_EQ(
      sorted_corners(read_bytes(packed_glb(positions, sequence(mesh), kFloat, kIndex32), ".glb")),
      plain_corners());
}

// As gltfpack writes them: positions as 16-bit integers, four to a vertex.
TEST(GltfMeshopt, IsReadWithQuantizedPositions) {
  const mesh::Mesh mesh = cube();
  std::vector<std::int16_t> values;
  for (const mesh::Vec3d& v : mesh.vertices) {
    for (const double x : v) values.push_back(static_cast<std::int16_t>(x));
    values.push_back(0);
  }
  const auto read =
      read_bytes(packed_glb(attributes(values, 8), triangles(mesh, 4), kShort, kIndex32), ".glb");
  mesh::Mesh rounded = mesh;
  for (mesh::Vec3d& v : rounded.vertices) {
    for (double& x : v) x = static_cast<std::int16_t>(x);
  }
  EXPECT_EQ(sorted_corners(read), sorted_corners(read_bytes(as_glb(rounded), ".glb")));
  ASSERT_EQ(read->warnings.size(), 1u);
  EXPECT_NE(read->warnings[0].find("KHR_mesh_quantization"), std::string::npos);
}

TEST(GltfMeshopt, IsReadWithTheExponentialFilter) {
  const mesh::Mesh mesh = cube();
  std::vector<std::uint32_t> packed(3 * mesh.vertices.size());
  meshopt_encodeFilterExp(packed.data(), mesh.vertices.size(), 12, 24, floats_of(mesh).data());
  EXPECT_EQ(sorted_corners(read_bytes(packed_glb(attributes(packed, 12, "EXPONENTIAL"),
                                                 triangles(mesh, 4), kFloat, kIndex32),
                                      ".glb")),
            plain_corners());
}

TEST(GltfMeshopt, ADamagedStreamIsReadOrRefused) {
  const mesh::Mesh mesh = cube();
  const View positions = attributes(floats_of(mesh), 12), indices = triangles(mesh, 4);
  int refused = 0;
  for (std::size_t cut = 0; cut < positions.packed.size(); ++cut) {
    View shorter = positions;
    shorter.packed.resize(cut);
    const auto read = read_bytes(packed_glb(shorter, indices, kFloat, kIndex32), ".glb");
    refused += !read;
  }
  EXPECT_GT(refused, static_cast<int>(positions.packed.size()) / 2);
  std::mt19937_64 random(3);
  for (int n = 0; n < 500; ++n) {
    View a = positions, b = indices;
    std::string& damaged = n % 2 == 0 ? a.packed : b.packed;
    damaged[random() % damaged.size()] ^= static_cast<char>(1u << random() % 8);
    const auto read = read_bytes(packed_glb(a, b, kFloat, kIndex32), ".glb");
    if (!read) {
      EXPECT_EQ(exit_status(read.error().code), 3);
    }
  }
  for (const auto& [mode, filter] : {std::pair("ATTRIBUTES", "QUATERNION"),
                                     {"ATTRIBUTES", "none"},
                                     {"VERTICES", "NONE"},
                                     {"INDICES", "EXPONENTIAL"}}) {
    View wrong = positions;
    wrong.mode = mode, wrong.filter = filter;
    const auto read = read_bytes(packed_glb(wrong, indices, kFloat, kIndex32), ".glb");
    ASSERT_FALSE(read) << mode << " " << filter;
    EXPECT_EQ(read.error().code, ErrorCode::kMeshUnreadable);
  }
}

TEST(GltfMeshopt, CountsThatNoStreamHasTakeNoMemory) {
  const mesh::Mesh mesh = cube();
  View huge = attributes(floats_of(mesh), 12);
  for (const std::size_t count : {std::size_t{1} << 40, ~std::size_t{0} / 12, ~std::size_t{0}}) {
    huge.count = count;
    const auto read = read_bytes(packed_glb(huge, triangles(mesh, 4), kFloat, kIndex32), ".glb");
    ASSERT_FALSE(read);
    EXPECT_EQ(exit_status(read.error().code), 3);
  }
}

#else

TEST(GltfMeshopt, IsNamedWhereTheBuildLacksTheLibrary) {
  const View nothing{"", "ATTRIBUTES", "NONE", 1, 12};
  const auto read = read_bytes(packed_glb(nothing, nothing, kFloat, kIndex32), ".glb");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kMeshUnsupported);
  EXPECT_NE(read.error().mend.find("libmeshoptimizer-dev"), std::string::npos);
}

#endif

}  // namespace
}  // namespace forcelayer

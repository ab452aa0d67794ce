// Random soups come back from every format corner for corner, whatever is wrong with them as
// surfaces.
#include <gtest/gtest.h>

#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

using namespace test;

void expect_same(const mesh::Mesh& mesh, const std::string& bytes, const std::string& extension,
                 std::uint64_t seed) {
  const Result<mesh::Assembly> assembly = read_bytes(bytes, extension);
  ASSERT_TRUE(assembly) << extension << " seed " << seed << ": " << to_line(assembly.error());
  EXPECT_EQ(corners_of(*assembly), corners_of(mesh)) << extension << " seed " << seed;
  ASSERT_EQ(assembly->instances.size(), 1u);
}

TEST(MeshFormats, GiveRandomSoupsBackUnchanged) {
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    std::mt19937_64 random(seed);
    const mesh::Mesh mesh = random_soup(random);
    expect_same(mesh, as_stl_binary(mesh), ".stl", seed);
    expect_same(mesh, as_stl_binary(mesh, "solid but binary"), ".stl", seed);
    expect_same(mesh, as_stl_ascii(mesh), ".stl", seed);
    expect_same(mesh, as_obj(mesh), ".obj", seed);
    expect_same(mesh, as_off(mesh), ".off", seed);
    expect_same(mesh, as_ply_ascii(mesh), ".ply", seed);
    expect_same(mesh, as_ply_binary(mesh, std::endian::little), ".ply", seed);
    expect_same(mesh, as_ply_binary(mesh, std::endian::big), ".ply", seed);
    expect_same(mesh, as_glb(mesh), ".glb", seed);
  }
}

// Decimal text keeps doubles; only what the format stores in 32 bits is 32 bits.
TEST(MeshFormats, KeepThePrecisionOfTheFile) {
  mesh::Mesh mesh = cube();
  mesh.vertices[1][0] = 0.1;  // no 32-bit float
  for (const auto& [bytes, extension] : {std::pair{as_obj(mesh), ".obj"},
                                         {as_off(mesh), ".off"},
                                         {as_ply_ascii(mesh), ".ply"},
                                         {as_stl_ascii(mesh), ".stl"}}) {
    const auto assembly = read_bytes(bytes, extension);
    ASSERT_TRUE(assembly) << to_line(assembly.error());
    EXPECT_EQ(corners_of(*assembly), corners_of(mesh)) << extension;
    EXPECT_FALSE(assembly->meshes[0].single_precision) << extension;
  }
  for (const auto& [bytes, extension] : {std::pair{as_stl_binary(mesh), ".stl"},
                                         {as_glb(mesh), ".glb"},
                                         {as_ply_binary(mesh, std::endian::little), ".ply"}}) {
    EXPECT_TRUE(read_bytes(bytes, extension)->meshes[0].single_precision) << extension;
  }
}

// A byte order mark stands before text, and changes nothing: not the number of the first vertex.
TEST(MeshFormats, AByteOrderMarkIsSkipped) {
  const std::string mark = "\xef\xbb\xbf";
  std::mt19937_64 random(3);
  const mesh::Mesh mesh = random_soup(random);
  expect_same(mesh, mark + as_stl_ascii(mesh), ".stl", 3);
  expect_same(mesh, mark + as_obj(mesh), ".obj", 3);
  expect_same(mesh, mark + as_off(mesh), ".off", 3);
  expect_same(mesh, mark + as_ply_ascii(mesh), ".ply", 3);
  expect_same(mesh, mark + as_ply_binary(mesh, std::endian::little), ".ply", 3);
  // Files joined to one have it in the middle.
  const std::string first = "v 5 5 5\n", faces = "f 2 3 4\n";
  const auto joined =
      read_bytes(first + mark + "v 0 0 0\nv 1 0 0\n" + mark + "v 0 1 0\n" + mark + faces, ".obj");
  ASSERT_TRUE(joined) << to_line(joined.error());
  const auto plain = read_bytes(first + "v 0 0 0\nv 1 0 0\nv 0 1 0\n" + faces, ".obj");
  EXPECT_EQ(corners_of(*joined), corners_of(*plain));
}

// They would make boxes, and what is computed from boxes, larger.
TEST(MeshFormats, VerticesWithoutTrianglesDoNotCount) {
  mesh::Mesh mesh = cube();
  const mesh::Box box = mesh::box_of(mesh, {});
  const auto corners = corners_of(mesh);
  mesh.vertices.insert(mesh.vertices.begin(), {5e6, 0, 0});
  for (mesh::Triangle& triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle) ++corner;
  }
  mesh.vertices.push_back({0, 0, -7e9});
  for (const auto& [bytes, extension] : {std::pair{as_obj(mesh), ".obj"},
                                         {as_off(mesh), ".off"},
                                         {as_ply_ascii(mesh), ".ply"},
                                         {as_glb(mesh), ".glb"}}) {
    const auto assembly = read_bytes(bytes, extension);
    ASSERT_TRUE(assembly) << to_line(assembly.error());
    EXPECT_EQ(corners_of(*assembly), corners) << extension;
    EXPECT_EQ(assembly->meshes[0].vertices.size(), 8u) << extension;
    EXPECT_EQ(assembly->instances[0].box.low, box.low) << extension;
    EXPECT_EQ(assembly->instances[0].box.high, box.high) << extension;
  }
}

}  // namespace
}  // namespace forcelayer

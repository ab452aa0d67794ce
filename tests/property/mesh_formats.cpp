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

}  // namespace
}  // namespace forcelayer

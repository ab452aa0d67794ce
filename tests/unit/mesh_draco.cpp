// Draco streams of both encodings, whole files and primitives of glTF.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "formats/mesh/mesh_facts.h"
#include "tests/support/draco_files.h"
#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

using namespace test;

TEST(DracoReader, GivesUnquantizedSoupsBackUnchanged) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    std::mt19937_64 random(seed);
    const mesh::Mesh mesh = random_soup(random);
    // Draco's decoder refuses its encoder's streams with more vertices than faces have corners.
    if (mesh.vertices.size() > 3 * mesh.triangles.size()) continue;
    const auto assembly = read_bytes(as_drc(mesh), ".drc");
    ASSERT_TRUE(assembly) << "seed " << seed << ": " << to_line(assembly.error());
    EXPECT_EQ(corners_of(*assembly), corners_of(mesh)) << "seed " << seed;
    EXPECT_TRUE(assembly->warnings.empty()) << assembly->warnings[0];
  }
}

TEST(DracoReader, ReadsTheEdgebreakerEncoding) {
  const auto assembly = read_bytes(as_drc(cube(), {.edgebreaker = true}), ".drc");
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  const mesh::MeshFacts facts = mesh::mesh_facts(assembly->meshes[0]);
  EXPECT_EQ(facts.triangles, 12u);
  EXPECT_TRUE(facts.closed);
  EXPECT_DOUBLE_EQ(facts.signed_volume, 1);
}

// Every vertex lies within the distance that the warning declares.
TEST(DracoReader, DeclaresWhatQuantizationCost) {
  for (const int bits : {6, 11, 14}) {
    std::mt19937_64 random(static_cast<std::uint64_t>(bits));
    mesh::Mesh mesh;
    for (int i = 0; i < 300; ++i) {
      std::uniform_real_distribution<float> coordinate(-7, 13);
      mesh.vertices.push_back({coordinate(random), coordinate(random), coordinate(random)});
      if (i % 3 == 2) {
        const auto first = static_cast<std::uint32_t>(i - 2);
        mesh.triangles.push_back({first, first + 1, first + 2});
      }
    }
    const auto assembly = read_bytes(as_drc(mesh, {.position_bits = bits}), ".drc");
    ASSERT_TRUE(assembly) << to_line(assembly.error());
    ASSERT_EQ(assembly->warnings.size(), 1u);
    int said_bits = 0;
    double step = 0, bound = 0;
    ASSERT_EQ(
        std::sscanf(assembly->warnings[0].c_str(),
                    "Draco rounded the positions to %d bits, in steps of %lf file units: every "
                    "vertex may be off by %lf",
                    &said_bits, &step, &bound),
        3)
        << assembly->warnings[0];
    EXPECT_EQ(said_bits, bits);
    double largest = 0;
    const Corners read = corners_of(*assembly), written = corners_of(mesh);
    ASSERT_EQ(read.size(), written.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
      for (std::size_t c = 0; c < 3; ++c) {
        largest = std::max(
            largest, std::hypot(read[i][c][0] - written[i][c][0], read[i][c][1] - written[i][c][1],
                                read[i][c][2] - written[i][c][2]));
      }
    }
    EXPECT_LE(largest, bound * 1.0001);  // the warning has six digits
    EXPECT_GT(largest, 0.3 * bound);     // and is no empty bound
  }
}

// A glTF primitive whose geometry is a Draco stream; `corners` is what its accessor announces.
std::string as_draco_glb(const mesh::Mesh& mesh, const DracoChoice& choice, std::size_t corners) {
  const std::string stream = as_drc(mesh, choice);
  return as_glb(
      R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_draco_mesh_compression"],
          "scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"name":"part"}],"meshes":[{"primitives":[
          {"attributes":{"POSITION":0},"indices":1,"extensions":{"KHR_draco_mesh_compression":
          {"bufferView":0,"attributes":{"POSITION":0}}}}]}],"accessors":[
          {"componentType":5126,"type":"VEC3","count":)" +
          std::to_string(mesh.vertices.size()) +
          R"(},{"componentType":5125,"type":"SCALAR","count":)" + std::to_string(corners) +
          R"(}],"bufferViews":[{"buffer":0,"byteLength":)" + std::to_string(stream.size()) +
          R"(}],"buffers":[{"byteLength":)" + std::to_string(stream.size()) + "}]}",
      stream);
}

TEST(DracoReader, ReadsCompressedPrimitivesOfGltf) {
  const mesh::Mesh mesh = cube();
  const auto assembly = read_bytes(as_draco_glb(mesh, {}, 36), ".glb");
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  EXPECT_EQ(corners_of(*assembly), corners_of(mesh));
  EXPECT_EQ(assembly->instances[0].name, "part");
  const auto quantized = read_bytes(as_draco_glb(mesh, {.position_bits = 8}, 36), ".glb");
  ASSERT_TRUE(quantized) << to_line(quantized.error());
  EXPECT_EQ(quantized->warnings.size(), 1u);
}

TEST(DracoReader, HoldsThePrimitiveAgainstItsAccessor) {
  const auto assembly = read_bytes(as_draco_glb(cube(), {}, 39), ".glb");
  ASSERT_FALSE(assembly);
  EXPECT_EQ(assembly.error().code, ErrorCode::kMeshIncomplete);
  EXPECT_EQ(assembly.error().where, "meshes[0].primitives[0]");
}

// A count that the decoder would believe: eleven bytes of header, then the number of faces.
TEST(DracoReader, TakesNoMoreMemoryThanItsSizeAllows) {
  std::string stream = as_drc(cube());
  ASSERT_EQ(stream[11], 12);
  stream.replace(11, 1, "\xff\xff\xff\xff\x0f");
  const auto assembly = read_bytes(stream, ".drc");
  ASSERT_FALSE(assembly);
  EXPECT_EQ(assembly.error().code, ErrorCode::kMeshIncomplete);
  EXPECT_NE(assembly.error().what.find("announces 4294967295 faces"), std::string::npos);
}

}  // namespace
}  // namespace forcelayer

// Every prefix of a small file of each format, and the file with every byte turned over: a clear
// error or a mesh that is whole, never a crash and never fewer triangles than announced.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/draco_files.h"
#include "tests/support/mesh_files.h"
#include "tests/support/om_files.h"

namespace forcelayer {
namespace {

using namespace test;

struct Sample {
  const char* name;
  const char* extension;
  bool announces_counts;  // a cut is seen
  std::string bytes;
};

std::vector<Sample> samples() {
  FloatMesh om_mesh;
  add_square_cube(om_mesh);
  const mesh::Mesh mesh = cube();
  return {
      {"StlBinary", ".stl", true, as_stl_binary(mesh)},
      {"StlAscii", ".stl", true, as_stl_ascii(mesh)},
      {"Obj", ".obj", false, as_obj(mesh)},
      {"Off", ".off", true, as_off(mesh)},
      {"PlyAscii", ".ply", true, as_ply_ascii(mesh)},
      {"PlyLittle", ".ply", true, as_ply_binary(mesh, std::endian::little)},
      {"PlyBig", ".ply", true, as_ply_binary(mesh, std::endian::big)},
      {"Glb", ".glb", true, as_glb(mesh)},
      {"Om", ".om", true, as_om(om_mesh)},
      {"OmOld", ".om", true, as_om_1_2(mesh)},
      {"DracoSequential", ".drc", true, as_drc(mesh)},
      {"DracoQuantized", ".drc", true, as_drc(mesh, {.position_bits = 10})},
      {"DracoEdgebreaker", ".drc", true, as_drc(mesh, {.position_bits = 10, .edgebreaker = true})},
  };
}

class DamagedMesh : public testing::TestWithParam<Sample> {
 protected:
  Result<mesh::Assembly> read(const std::string& bytes) {
    return read_bytes(bytes, GetParam().extension);
  }

  // Whatever is read keeps the promises of Mesh.
  void expect_sound(const mesh::Assembly& assembly) {
    for (const mesh::MeshInstance& instance : assembly.instances) {
      ASSERT_LT(instance.mesh, assembly.meshes.size());
    }
    for (const mesh::Mesh& mesh : assembly.meshes) {
      for (const mesh::Vec3d& vertex : mesh.vertices) {
        for (const double coordinate : vertex) ASSERT_TRUE(std::isfinite(coordinate));
      }
      for (const mesh::Triangle& triangle : mesh.triangles) {
        for (const std::uint32_t corner : triangle) ASSERT_LT(corner, mesh.vertices.size());
      }
    }
  }
};

TEST_P(DamagedMesh, CutShortIsAnError) {
  const std::string& bytes = GetParam().bytes;
  const auto whole = read(bytes);
  ASSERT_TRUE(whole) << to_line(whole.error());
  ASSERT_EQ(whole->triangle_count(), 12u);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const auto cut = read(bytes.substr(0, size));
    if (!cut) {
      EXPECT_FALSE(cut.error().what.empty()) << size << " bytes";
      EXPECT_EQ(exit_status(cut.error().code), 3) << to_line(cut.error());
      continue;
    }
    expect_sound(*cut);
    // The last word of a text file may lose digits unseen. OBJ has no counts and may lose more.
    if (GetParam().announces_counts) {
      EXPECT_EQ(cut->triangle_count(), 12u) << size << " bytes";
    }
  }
}

TEST_P(DamagedMesh, WithAByteTurnedOverIsAnErrorOrSound) {
  std::string bytes = GetParam().bytes;
  std::uint64_t errors = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    for (const unsigned char flip : {0xff, 0x80, 0x01}) {
      bytes[i] = static_cast<char>(bytes[i] ^ flip);
      const auto changed = read(bytes);
      if (changed) {
        expect_sound(*changed);
      } else {
        ++errors;
        EXPECT_FALSE(changed.error().what.empty());
      }
      bytes[i] = static_cast<char>(bytes[i] ^ flip);
    }
  }
  EXPECT_GT(errors, 0u);
}

INSTANTIATE_TEST_SUITE_P(EveryFormat, DamagedMesh, testing::ValuesIn(samples()),
                         [](const auto& sample) { return std::string(sample.param.name); });

}  // namespace
}  // namespace forcelayer

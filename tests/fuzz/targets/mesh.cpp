// A mesh file of the format FUZZ_EXTENSION: an error that says something, or a sound mesh.
#include <cmath>

#include "formats/mesh/mesh_facts.h"
#include "formats/mesh/reader.h"
#include "tests/fuzz/work.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace forcelayer;
  // By our code alone: libraries do not count. The seeds take up to 28 blocks a byte, and glTF may
  // unfold to 32 numbers a byte.
  constexpr fuzz::WorkBound kReading{100'000, 2'000};
  const auto assembly = fuzz::within(kReading, size, [&] {
    return mesh::read_source({"fuzz" FUZZ_EXTENSION, fuzz::text_of(data, size), {}});
  });
  if (!assembly) {
    fuzz::require(!assembly.error().what.empty(), "an error says what is wrong");
    return 0;
  }
  fuzz::require(!assembly->instances.empty(), "what is read is not empty");
  for (const mesh::MeshInstance& instance : assembly->instances) {
    fuzz::require(instance.mesh < assembly->meshes.size(), "instances name meshes");
  }
  for (const mesh::Mesh& mesh : assembly->meshes) {
    for (const mesh::Vec3d& vertex : mesh.vertices) {
      for (const double coordinate : vertex) {
        fuzz::require(std::isfinite(coordinate), "vertices are finite");
      }
    }
    for (const mesh::Triangle& triangle : mesh.triangles) {
      for (const std::uint32_t corner : triangle) {
        fuzz::require(corner < mesh.vertices.size(), "triangles name vertices");
      }
    }
    (void)mesh::mesh_facts(mesh);
  }
  return 0;
}

// OpenMesh files for tests, written by OpenMesh and, in the old version 1.2, by hand.
#pragma once

// OpenMesh's vectors are uninitialised on purpose where they are made.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/mesh_files.h"

namespace forcelayer::test {

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
};
using DoubleMesh = OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits>;
using FloatMesh = OpenMesh::PolyMesh_ArrayKernelT<>;

// The unit cube of six squares; `mesh` may have properties requested before or after.
template <typename OmMesh>
void add_square_cube(OmMesh& mesh) {
  std::vector<OpenMesh::VertexHandle> v;
  for (int i = 0; i < 8; ++i) {
    v.push_back(mesh.add_vertex(typename OmMesh::Point(i & 1, i >> 1 & 1, i >> 2 & 1)));
  }
  constexpr int kFaces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (const auto& face : kFaces) {
    mesh.add_face(
        std::vector<OpenMesh::VertexHandle>{v[face[0]], v[face[1]], v[face[2]], v[face[3]]});
  }
}

template <typename OmMesh>
std::string as_om(OmMesh& mesh, OpenMesh::IO::Options options = {}) {
  std::ostringstream stream;
  omlog().disable();  // the writer reports its byte count there
  options += OpenMesh::IO::Options::Binary;
  const bool done = OpenMesh::IO::write_mesh(mesh, stream, ".om", options);
  if (!done) throw std::runtime_error("no OM file");
  return stream.str();
}

// Version 1.2, where faces are lists of vertices: any soup at all.
inline std::string as_om_1_2(const mesh::Mesh& mesh) {
  std::string bytes = "OMT";
  bytes += static_cast<char>(1 << 5 | 2);
  put(bytes, static_cast<std::uint32_t>(mesh.vertices.size()));
  put(bytes, static_cast<std::uint32_t>(mesh.triangles.size()));
  put(bytes, std::uint32_t{0});
  constexpr std::uint16_t kFloat = 1 << 10, kThree = 2 << 11, k32Bits = 2 << 14, kFace = 2 << 2,
                          kTopology = 7 << 5;
  put(bytes, static_cast<std::uint16_t>(kFloat | kThree));  // positions of vertices
  for (const mesh::Vec3d& vertex : mesh.vertices) {
    for (const double coordinate : vertex) put(bytes, static_cast<float>(coordinate));
  }
  put(bytes, static_cast<std::uint16_t>(kFace | kTopology | k32Bits));
  for (const mesh::Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) put(bytes, corner);
  }
  return bytes;
}

}  // namespace forcelayer::test

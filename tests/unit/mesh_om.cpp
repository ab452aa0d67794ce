// OpenMesh files as OpenMesh writes them, with everything that it can add.
#include <gtest/gtest.h>

#include "formats/mesh/mesh_facts.h"
#include "tests/support/om_files.h"

namespace forcelayer {
namespace {

using namespace test;

void expect_cube(const Result<mesh::Assembly>& assembly) {
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  const mesh::MeshFacts facts = mesh::mesh_facts(assembly->meshes[0]);
  EXPECT_EQ(facts.triangles, 12u);
  EXPECT_EQ(facts.vertices, 8u);
  EXPECT_TRUE(facts.closed);
  EXPECT_TRUE(facts.consistently_oriented);
  EXPECT_DOUBLE_EQ(facts.signed_volume, 1);
  EXPECT_DOUBLE_EQ(facts.area, 6);
}

TEST(OmReader, ReadsFloatsAndDoubles) {
  FloatMesh floats;
  add_square_cube(floats);
  DoubleMesh doubles;
  add_square_cube(doubles);
  doubles.set_point(OpenMesh::VertexHandle(0), {0.1, 0, 0});
  const auto read = read_bytes(as_om(doubles), ".om");
  ASSERT_TRUE(read) << to_line(read.error());
  EXPECT_EQ(read->meshes[0].vertices[0][0], 0.1);
  EXPECT_FALSE(read->meshes[0].single_precision);
  expect_cube(read_bytes(as_om(floats), ".om"));
  EXPECT_TRUE(read_bytes(as_om(floats), ".om")->meshes[0].single_precision);
}

TEST(OmReader, StepsOverEveryOtherChunk) {
  DoubleMesh mesh;
  add_square_cube(mesh);
  mesh.request_vertex_normals();
  mesh.request_face_normals();
  mesh.request_vertex_colors();
  mesh.request_face_colors();
  mesh.request_edge_colors();
  mesh.request_vertex_status();
  mesh.request_halfedge_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  mesh.request_vertex_texcoords2D();
  mesh.request_halfedge_texcoords2D();
  mesh.update_normals();
  OpenMesh::VPropHandleT<int> weight;
  mesh.add_property(weight, "weight");
  mesh.property(weight).set_persistent(true);
  OpenMesh::FPropHandleT<std::string> name;
  mesh.add_property(name, "name");
  mesh.property(name).set_persistent(true);
  using Options = OpenMesh::IO::Options;
  Options options = Options::VertexNormal;
  for (const auto more :
       {Options::FaceNormal, Options::VertexColor, Options::FaceColor, Options::EdgeColor,
        Options::Status, Options::VertexTexCoord, Options::FaceTexCoord}) {
    options += more;
  }
  expect_cube(read_bytes(as_om(mesh, options), ".om"));
}

// Faces that a halfedge mesh could not hold.
TEST(OmReader, KeepsEveryFaceOfOldFiles) {
  mesh::Mesh mesh = cube();
  mesh.triangles.push_back(mesh.triangles[0]);
  mesh.triangles.push_back({0, 7, 0});
  mesh.triangles.push_back({0, 3, 4});
  const auto assembly = read_bytes(as_om_1_2(mesh), ".om");
  ASSERT_TRUE(assembly) << to_line(assembly.error());
  EXPECT_EQ(corners_of(*assembly), corners_of(mesh));
}

TEST(OmReader, RefusesDeletedFaces) {
  FloatMesh mesh;
  add_square_cube(mesh);
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  mesh.delete_face(OpenMesh::FaceHandle(2), false);
  const auto assembly = read_bytes(as_om(mesh, OpenMesh::IO::Options::Status), ".om");
  ASSERT_FALSE(assembly);
  EXPECT_NE(to_line(assembly.error()).find("deleted"), std::string::npos);
}

// OpenMesh throws at them; found by fuzzing.
TEST(OmReader, RefusesHandlesOfEightBytes) {
  std::string bytes = "OMT";
  bytes += static_cast<char>(2 << 5 | 2);                         // version 2.2
  for (const std::uint32_t count : {0, 0, 1}) put(bytes, count);  // vertices, faces, edges
  constexpr unsigned kHalfedge = 6 << 2, kTopology = 7 << 5, k64Bits = 3 << 14;
  put(bytes, static_cast<std::uint16_t>(kHalfedge | kTopology | k64Bits));
  bytes.append(2 * 3 * 8, '\0');
  const auto assembly = read_bytes(bytes, ".om");
  ASSERT_FALSE(assembly);
  EXPECT_EQ(assembly.error().code, ErrorCode::kMeshUnsupported);
  EXPECT_NE(to_line(assembly.error()).find("OpenMesh reports"), std::string::npos);
}

}  // namespace
}  // namespace forcelayer

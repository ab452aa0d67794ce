#include "formats/mesh/mesh_facts.h"

#include <gtest/gtest.h>

#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

using test::cube;

TEST(MeshFacts, OfACube) {
  mesh::Mesh mesh = cube();
  for (mesh::Vec3d& vertex : mesh.vertices) vertex[0] = 2 * vertex[0] + 100;
  const mesh::MeshFacts facts = mesh::mesh_facts(mesh);
  EXPECT_EQ(facts.triangles, 12u);
  EXPECT_EQ(facts.distinct_vertices, 8u);
  EXPECT_TRUE(facts.closed);
  EXPECT_TRUE(facts.consistently_oriented);
  EXPECT_EQ(facts.boundary_edges + facts.non_manifold_edges + facts.flipped_edges, 0u);
  EXPECT_EQ(facts.degenerate_triangles + facts.duplicate_triangles, 0u);
  EXPECT_EQ(facts.min, (mesh::Vec3d{100, 0, 0}));
  EXPECT_EQ(facts.max, (mesh::Vec3d{102, 1, 1}));
  EXPECT_DOUBLE_EQ(facts.area, 10);
  EXPECT_DOUBLE_EQ(facts.signed_volume, 2);
}

TEST(MeshFacts, TakeEqualVerticesAsOne) {
  mesh::Mesh mesh = cube();
  mesh::Mesh loose;
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto first = static_cast<std::uint32_t>(loose.vertices.size());
    for (const std::uint32_t corner : {a, b, c}) loose.vertices.push_back(mesh.vertices[corner]);
    loose.triangles.push_back({first, first + 1, first + 2});
  }
  loose.vertices[0][0] = -0.0;
  const mesh::MeshFacts facts = mesh::mesh_facts(loose);
  EXPECT_EQ(facts.vertices, 36u);
  EXPECT_EQ(facts.distinct_vertices, 8u);
  EXPECT_TRUE(facts.closed);
}

TEST(MeshFacts, OfDamagedCubes) {
  mesh::Mesh open = cube();
  open.triangles.pop_back();
  EXPECT_EQ(mesh::mesh_facts(open).boundary_edges, 3u);
  EXPECT_FALSE(mesh::mesh_facts(open).closed);
  EXPECT_TRUE(mesh::mesh_facts(open).consistently_oriented);

  mesh::Mesh flipped = cube();
  std::swap(flipped.triangles[0][1], flipped.triangles[0][2]);
  EXPECT_EQ(mesh::mesh_facts(flipped).flipped_edges, 3u);
  EXPECT_TRUE(mesh::mesh_facts(flipped).closed);
  EXPECT_FALSE(mesh::mesh_facts(flipped).consistently_oriented);

  mesh::Mesh doubled = cube();
  doubled.triangles.push_back({3, 0, 2});
  EXPECT_EQ(mesh::mesh_facts(doubled).duplicate_triangles, 1u);
  EXPECT_EQ(mesh::mesh_facts(doubled).non_manifold_edges, 3u);

  mesh::Mesh degenerate = cube();
  degenerate.triangles.push_back({0, 0, 1});  // a point twice
  degenerate.vertices.push_back({2, 0, 0});
  degenerate.triangles.push_back({0, 1, 8});  // in a line
  EXPECT_EQ(mesh::mesh_facts(degenerate).degenerate_triangles, 2u);
}

TEST(MeshFacts, OfNothing) {
  const mesh::MeshFacts facts = mesh::mesh_facts({});
  EXPECT_FALSE(facts.closed);
  EXPECT_EQ(facts.area, 0);
}

}  // namespace
}  // namespace forcelayer

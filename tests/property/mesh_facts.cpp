// mesh_facts() against counting by maps of coordinates.
#include "formats/mesh/mesh_facts.h"

#include <gtest/gtest.h>

#include <map>
#include <set>

#include "tests/support/mesh_files.h"

namespace forcelayer {
namespace {

using namespace test;

// Few grid points, so that vertices meet, triangles repeat and edges have many triangles.
mesh::Mesh random_grid_soup(std::mt19937_64& random) {
  mesh::Mesh mesh;
  const std::size_t vertices = 3 + random() % 20;
  for (std::size_t i = 0; i < vertices; ++i) {
    const auto coordinate = [&] { return static_cast<double>(random() % 3) - 1; };
    mesh.vertices.push_back({coordinate(), coordinate(), coordinate()});
  }
  const std::size_t triangles = random() % 30;
  for (std::size_t i = 0; i < triangles; ++i) {
    const auto corner = [&] { return static_cast<std::uint32_t>(random() % vertices); };
    mesh.triangles.push_back({corner(), corner(), corner()});
  }
  return mesh;
}

using EdgeUses = std::map<std::pair<mesh::Vec3d, mesh::Vec3d>, std::pair<int, int>>;  // up, down

EdgeUses edge_uses(const mesh::Mesh& mesh) {
  EdgeUses uses;
  for (const auto& corners : corners_of(mesh)) {
    if (std::set<mesh::Vec3d>(corners.begin(), corners.end()).size() < 3) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const mesh::Vec3d &from = corners[i], &to = corners[(i + 1) % 3];
      auto& [up, down] = uses[{std::min(from, to), std::max(from, to)}];
      ++(from < to ? up : down);
    }
  }
  return uses;
}

TEST(MeshFacts, EqualThoseCountedByMaps) {
  for (std::uint64_t seed = 0; seed < 500; ++seed) {
    std::mt19937_64 random(seed);
    const mesh::Mesh mesh = random_grid_soup(random);
    const mesh::MeshFacts facts = mesh::mesh_facts(mesh);
    const std::set<mesh::Vec3d> distinct(mesh.vertices.begin(), mesh.vertices.end());
    EXPECT_EQ(facts.distinct_vertices, distinct.size()) << "seed " << seed;
    std::set<std::multiset<mesh::Vec3d>> triangles;
    for (const auto& corners : corners_of(mesh)) triangles.insert({corners.begin(), corners.end()});
    EXPECT_EQ(facts.duplicate_triangles, mesh.triangles.size() - triangles.size()) << seed;
    std::uint64_t boundary = 0, non_manifold = 0, flipped = 0;
    const EdgeUses uses = edge_uses(mesh);
    bool closed = !uses.empty(), oriented = !uses.empty();
    for (const auto& [edge, use] : uses) {
      const auto [up, down] = use;
      boundary += up + down == 1;
      non_manifold += up + down > 2;
      flipped += up + down == 2 && up != 1;
      closed = closed && (up + down) % 2 == 0;
      oriented = oriented && (up == down || up + down == 1);
    }
    EXPECT_EQ(facts.boundary_edges, boundary) << "seed " << seed;
    EXPECT_EQ(facts.non_manifold_edges, non_manifold) << "seed " << seed;
    EXPECT_EQ(facts.flipped_edges, flipped) << "seed " << seed;
    EXPECT_EQ(facts.closed, closed) << "seed " << seed;
    EXPECT_EQ(facts.consistently_oriented, oriented) << "seed " << seed;
  }
}

}  // namespace
}  // namespace forcelayer

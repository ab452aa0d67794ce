// Measures and defects of a mesh as a surface, for the reports of a bake.
#pragma once

#include <cstdint>

#include "formats/mesh/mesh.h"

namespace forcelayer::mesh {

// Vertices of equal coordinates count as one. An edge is a pair of such vertices; a triangle with
// two equal corners has none.
struct MeshFacts {
  std::uint64_t triangles = 0;
  std::uint64_t vertices = 0;
  std::uint64_t distinct_vertices = 0;
  std::uint64_t degenerate_triangles = 0;  // no area: equal corners, or corners in a line
  std::uint64_t duplicate_triangles = 0;   // the corners of an earlier triangle, either way round
  std::uint64_t boundary_edges = 0;        // of one triangle
  std::uint64_t non_manifold_edges = 0;    // of more than two
  std::uint64_t flipped_edges = 0;         // of two triangles that run along it the same way
  bool closed = false;                     // every edge has an even number of triangles
  bool consistently_oriented = false;      // inner edges are run along as often either way
  Vec3d min{0, 0, 0};                      // file units, mesh frame
  Vec3d max{0, 0, 0};
  double area = 0;           // file units^2
  double signed_volume = 0;  // file units^3; positive where a closed mesh faces outwards
};

double area_of(const Mesh& mesh);  // file units^2

// Looks at every triangle and edge once: a sort of three edges a triangle.
MeshFacts mesh_facts(const Mesh& mesh);

}  // namespace forcelayer::mesh

// Cuts large triangles, so that values at vertices show what lies between the vertices of a mesh.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <utility>
#include <vector>

#include "formats/mesh/writers/glb.h"

namespace forcelayer::exact {

// A node's triangles while they are cut.
struct SplitMesh {
  explicit SplitMesh(mesh::GlbNode whole)
      : node(std::move(whole)), is_far(node.triangles.size(), false) {}
  mesh::GlbNode node;        // with positions and triangles alone
  std::vector<char> is_far;  // [triangles] known not to be cut for their own sake
};

// Whether any point within `radius_m` of `center_m` matters.
using IsNear = std::function<bool(const std::array<float, 3>& center_m, double radius_m)>;

// Cuts all triangles that matter until their edges are no longer than `edge_m`. Edges are halved,
// by all triangles that have them, so that no gap opens between those that had common vertices.
// Vertices of the mesh stay in their order, before the new ones. Triangles keep their side.
void split_edges(SplitMesh& mesh, double edge_m, const IsNear& is_near);

// The longest edge, m.
double longest_edge_m(const mesh::GlbNode& node);

}  // namespace forcelayer::exact

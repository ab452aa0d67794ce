// Writes glTF 2.0 in its binary form, GLB.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/result.h"

namespace forcelayer::mesh {

// A node with a mesh of its own: at the origin of the world, unless a motion places it.
struct GlbNode {
  std::string name;
  std::vector<std::array<float, 3>> vertices_m;
  std::vector<Triangle> triangles;  // at least one; each vertex belongs to one or more of them
  std::array<double, 3> color{};    // linear RGB, 0 to 1
  // [vertices] or empty: their clearance, written as _CLEARANCE_M, and linear RGBA colors that
  // multiply `color`.
  std::vector<float> clearance_m;
  std::vector<std::array<std::uint8_t, 4>> colors;
};

// Poses of a node over time. Between two of them the position changes linearly, and the rotation by
// the smaller angle at constant speed.
struct GlbMotion {
  std::string name;
  std::size_t node = 0;                              // number of the node that moves
  std::vector<float> times_s;                        // from 0 on, ascending; at least one
  std::vector<std::array<float, 3>> positions_m;     // [times]
  std::vector<std::array<float, 4>> rotations_xyzw;  // [times] of length 1
};

// Writes the nodes in their order, below a node "world" that turns `up` to the y axis of glTF.
// Mesh, material, accessors and buffer views of node n stand before those of node n + 1, and the
// motion (null: none) before all of them, so that a reader can leave out the last nodes by cutting.
// A node that moves is placed at its first pose. `extras`: a JSON object for asset.extras; empty:
// none. Errors: kWriteFailed, and those of AtomicFile.
Status write_glb(const std::string& path, std::span<const GlbNode> nodes, const GlbMotion* motion,
                 Up up, const std::string& extras = "");

}  // namespace forcelayer::mesh

// The meshes that a scene and a part were baked from, as the surfaces whose distance is measured.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/path/path_file.h"
#include "formats/pshell.h"
#include "formats/result.h"
#include "formats/voxmap.h"
#include "runtime/voxcheck/exact_exchange.h"

namespace forcelayer::exact {

// Triangles in one frame.
struct Surface {
  std::vector<glm::dvec3> vertices_m;
  std::vector<mesh::Triangle> triangles;
  std::vector<std::uint32_t> object;  // [triangles] number in the voxmap; 0: it names none
  double largest_m = 0;               // of all coordinates
  double deviation_m = 0;             // of the true surface, as files and user state it
  // [number in the voxmap - 1] the same of each object; empty where objects are not told apart.
  std::vector<double> deviations_m = {};
};

// The scene in the world.
Result<Surface> read_scene_surface(const voxcheck::ExactRequest& request, const Voxmap& voxmap,
                                   std::vector<std::string>& warnings);

// The part about its centroid, PshellHeader::center_m.
Result<Surface> read_part_surface(const voxcheck::ExactRequest& request, const Pshell& shell,
                                  std::vector<std::string>& warnings);

// ExactAnswer::rules, by the names of the request's meshes, and warnings.
Result<voxcheck::ExactAnswer> read_rules(const voxcheck::ExactRequest& request,
                                         const Voxmap& voxmap, const Pshell& shell);

// How far a part's vertices lie from its centroid at most, m.
double radius_m(const Surface& part);

// The largest coordinate in any computation, the part at its farthest on the path included, m.
double largest_m(const Surface& scene, const Surface& part, std::span<const PathRow> rows);

// The triangles of those objects that are not among `left_out`.
Surface without(const Surface& surface, std::span<const std::uint32_t> left_out);

// The triangles of these objects, with their deviation alone.
Surface only(const Surface& surface, std::span<const std::uint32_t> objects);

}  // namespace forcelayer::exact

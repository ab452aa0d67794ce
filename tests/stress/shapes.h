// Triangle meshes of simple solids for the stress tests, in meters. Closed and facing outwards
// unless said otherwise.
#pragma once

#include <glm/vec2.hpp>
#include <vector>

#include "forcelayer/pose.h"
#include "formats/mesh/mesh.h"

namespace forcelayer::stress {

// Appends `other`, moved by `pose`, to `mesh`.
void append(mesh::Mesh& mesh, const mesh::Mesh& other, const Pose& pose = {});

// Box about the origin.
mesh::Mesh box(const glm::dvec3& half_m);

// A rectangle in the plane z = 0: two triangles, no thickness, not closed.
mesh::Mesh sheet(double half_x_m, double half_y_m);

// Surface of revolution about z of a closed polygon of (radius, height), radii not negative,
// counter-clockwise in the (radius, height) plane.
mesh::Mesh revolved(const std::vector<glm::dvec2>& profile_m, int segments);

mesh::Mesh sphere(double radius_m, int segments);
mesh::Mesh cylinder(double radius_m, double half_height_m, int segments);
mesh::Mesh tube(double inner_m, double outer_m, double half_height_m, int segments);

// Prism along y over a simple polygon of (x, z), counter-clockwise seen from -y, about y = 0. The
// polygon must be star-shaped about its first vertex.
mesh::Mesh prism(const std::vector<glm::dvec2>& polygon_m, double half_width_m);

// A helical ridge around z: right-handed, triangular profile of the given depth. Outwards
// (a bolt) from `radius_m` where `depth_m` is positive, inwards (a nut's thread) where negative.
// Open at its ends and at its root, where it meets the body: a soup.
mesh::Mesh thread(double radius_m, double depth_m, double pitch_m, double turns,
                  int segments_per_turn);

// Longest distance of a vertex from the origin.
double radius_m(const mesh::Mesh& mesh);

}  // namespace forcelayer::stress

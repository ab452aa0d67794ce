// Point shells of a sphere, a box, a cylinder, a cone and a torus whose covering radius follows
// from their construction, and whose weights are exact areas.
#pragma once

#include <glm/vec3.hpp>
#include <vector>

namespace forcelayer::bench {

struct AnalyticShell {
  std::vector<glm::dvec3> points_m, normals;  // about the center; inward
  std::vector<double> areas_m2;
  double covering_radius_m = 0;
  double radius_m = 0;  // of all points
  double area_m2 = 0;
};

AnalyticShell sphere_shell(double radius_m, double covering_radius_m);
AnalyticShell box_shell(const glm::dvec3& half_m, double covering_radius_m);
AnalyticShell cylinder_shell(double radius_m, double half_length_m, double covering_radius_m);

// About z, the base a quarter of the height below the origin (the centroid), the tip above. The
// radius must be less than half of the slant, so that the side unrolls to a convex sector.
AnalyticShell cone_shell(double radius_m, double height_m, double covering_radius_m);

// About z.
AnalyticShell torus_shell(double ring_m, double tube_m, double covering_radius_m);

}  // namespace forcelayer::bench

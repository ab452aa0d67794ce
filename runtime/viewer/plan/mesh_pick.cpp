#include "runtime/viewer/plan/mesh_pick.h"

#include <glm/geometric.hpp>
#include <limits>

namespace forcelayer::viewer {
namespace {

glm::dvec3 point_of(const ViewMesh& mesh, std::uint32_t n) {
  const auto& p = mesh.points[n];
  return {double{p[0]}, double{p[1]}, double{p[2]}};
}

// How far along the ray it meets the triangle; infinity where it misses (Moeller and Trumbore
// 1997).
double distance_to(const Ray& ray, const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  constexpr double kMissed = std::numeric_limits<double>::infinity();
  const glm::dvec3 ab = b - a, ac = c - a, across = glm::cross(ray.along, ac);
  const double determinant = glm::dot(ab, across);
  if (determinant == 0) return kMissed;
  const glm::dvec3 from_a = ray.from_m - a;
  const double u = glm::dot(from_a, across) / determinant;
  if (!(u >= 0 && u <= 1)) return kMissed;
  const glm::dvec3 other = glm::cross(from_a, ab);
  const double v = glm::dot(ray.along, other) / determinant;
  if (!(v >= 0 && u + v <= 1)) return kMissed;
  const double along = glm::dot(ac, other) / determinant;
  return along >= 0 ? along : kMissed;
}

bool is_left(const std::optional<Cut>& cut, const glm::dvec3& place_m) {
  return !cut || (place_m[cut->axis] <= cut->at_m) == cut->keep_low;
}

}  // namespace

std::string_view mesh_on(const ViewScene& scene, const std::vector<char>& hidden, const Ray& ray,
                         const std::optional<Cut>& cut) {
  const Ray here{ray.from_m - scene.origin_m, ray.along};  // as the meshes' points are given
  std::string_view name;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t n = 0; n < scene.meshes.size(); ++n) {
    if (hidden[n] != 0) continue;
    const ViewMesh& mesh = scene.meshes[n];
    for (const mesh::Triangle& t : mesh.triangles) {
      const double along =
          distance_to(here, point_of(mesh, t[0]), point_of(mesh, t[1]), point_of(mesh, t[2]));
      if (!(along < nearest) || !is_left(cut, ray.from_m + along * ray.along)) continue;
      nearest = along;
      name = mesh.name;
    }
  }
  return name;
}

}  // namespace forcelayer::viewer

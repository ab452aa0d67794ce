#include "workbench/viewer/plan/mesh_pick.h"

#include <cmath>
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

// The same for the nearest triangle of a mesh, of those whose place `counts`.
template <typename Counts>
double distance_to(const Ray& ray, const ViewMesh& mesh, const Counts& counts) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const mesh::Triangle& t : mesh.triangles) {
    const double along =
        distance_to(ray, point_of(mesh, t[0]), point_of(mesh, t[1]), point_of(mesh, t[2]));
    if (along < nearest && counts(along)) nearest = along;
  }
  return nearest;
}

// And for the discs that are drawn of a shell, in the part's frame.
double distance_to(const Ray& ray, const Pshell& shell) {
  const PshellView& view = shell.view();
  const auto& center = shell.header().center_m;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::uint64_t n = 0; n < view.point_count; ++n) {
    const glm::dvec3 inward(view.nx[n], view.ny[n], view.nz[n]);
    const glm::dvec3 point(center[0] + double{view.x[n]}, center[1] + double{view.y[n]},
                           center[2] + double{view.z[n]});
    const double across = glm::dot(ray.along, inward);
    if (across == 0) continue;
    const double along = glm::dot(point - ray.from_m, inward) / across;
    if (!(along >= 0 && along < nearest)) continue;
    const double off_m = glm::distance(ray.from_m + along * ray.along, point);
    if (off_m <= shell.header().covering_radius_m) nearest = along;
  }
  return nearest;
}

bool is_left(const std::optional<Cut>& cut, const glm::dvec3& place_m) {
  return !cut || (place_m[cut->axis] <= cut->at_m) == cut->keep_low;
}

}  // namespace

std::optional<MeshHit> mesh_on(const ViewScene& scene, const std::vector<char>& hidden,
                               const Ray& ray, const std::optional<Cut>& cut) {
  const Ray here{ray.from_m - scene.origin_m, ray.along};  // as the meshes' points are given
  MeshHit hit{"", std::numeric_limits<double>::infinity()};
  const auto counts = [&](double along) {
    return along < hit.along && is_left(cut, ray.from_m + along * ray.along);
  };
  for (std::size_t n = 0; n < scene.meshes.size(); ++n) {
    if (hidden[n] != 0) continue;
    const double along = distance_to(here, scene.meshes[n], counts);
    if (along < hit.along) hit = {scene.meshes[n].name, along};
  }
  if (!std::isfinite(hit.along)) return std::nullopt;
  return hit;
}

std::optional<double> part_on(const ViewScene& scene, bool mesh, const Pose& world_from_part,
                              const Ray& ray) {
  const Pose part_from_world = inverse(world_from_part);
  const Ray here{part_from_world.orientation * ray.from_m + part_from_world.position_m,
                 part_from_world.orientation * ray.along};
  double along = std::numeric_limits<double>::infinity();
  if (mesh && scene.part) {
    along = distance_to(here, *scene.part, [](double) { return true; });
  } else if (!mesh && scene.shell) {
    along = distance_to(here, *scene.shell);
  }
  if (!std::isfinite(along)) return std::nullopt;
  return along;
}

}  // namespace forcelayer::viewer

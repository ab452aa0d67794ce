#include "runtime/run/start_check.h"

#include <cstdio>
#include <glm/common.hpp>
#include <string>
#include <vector>

#include "runtime/query/enclosed_object.h"

namespace forcelayer {

namespace {

// Whether distances grow along the outward normals of most points, from a voxel and a half inside
// to as far outside: farther than a distance is rounded, and than its voxel reaches.
bool grow_outward(const Voxmap& voxmap, const Pshell& shell, const Pose& world_from_center) {
  constexpr double kStepVoxels = 1.5;
  const double voxel_m = voxmap.voxel_size_m();
  const PshellView& v = shell.view();
  const auto distance_m = [&](const glm::dvec3& world_m) {
    const glm::dvec3 low = glm::floor(world_m / voxel_m);
    return voxmap.min_distance_m(static_cast<std::int64_t>(low.x), static_cast<std::int64_t>(low.y),
                                 static_cast<std::int64_t>(low.z));
  };
  std::int64_t growing = 0;
  for (std::uint64_t n = 0; n < v.point_count; ++n) {
    const glm::dvec3 point_m = world_from_center.position_m +
                               world_from_center.orientation * glm::dvec3(v.x[n], v.y[n], v.z[n]);
    const glm::dvec3 inward = world_from_center.orientation * glm::dvec3(v.nx[n], v.ny[n], v.nz[n]);
    const double outside_m = distance_m(point_m - kStepVoxels * voxel_m * inward);
    const double inside_m = distance_m(point_m + kStepVoxels * voxel_m * inward);
    growing += outside_m > inside_m ? 1 : outside_m < inside_m ? -1 : 0;
  }
  return growing > 0;
}

}  // namespace

Status check_start(const model::Simulation& simulation, const Pose& world_from_center) {
  const Voxmap& voxmap = simulation.voxmap();
  // An object of the seat that reaches into the part, as modeled, crosses its surface and is held
  // there.
  std::vector<std::uint32_t> felt;
  for (const guard::SeatObject& object : simulation.seat()) felt.push_back(object.object);
  const auto enclosed =
      query::find_enclosed_object(voxmap, simulation.shell(), world_from_center, felt);
  if (!enclosed) return enclosed.error();
  if (!*enclosed) return {};
  const std::string_view name = voxmap.object_name((*enclosed)->object);
  const glm::dvec3& p = (*enclosed)->world_m;
  char at[120];
  std::snprintf(
      at, sizeof at,
      " lies inside the part at x %.2f, y %.2f, z %.2f mm, where the part has no shell points",
      1e3 * p.x, 1e3 * p.y, 1e3 * p.z);
  return Error{ErrorCode::kUsage, "", "start",
               (name.empty() ? std::string("an object") : std::string(name)) + at,
               "bake the scene without this object (--without), start elsewhere (--start), or use "
               "--without-guarantee (in code: without_guarantee)"};
}

std::optional<std::string> part_in_scene_warning(const Voxmap& voxmap, const Pshell& shell,
                                                 const Pose& world_from_center,
                                                 std::uint64_t seat_points) {
  if (seat_points != shell.header().point_count) return {};
  if (voxmap.distances() != nullptr && !grow_outward(voxmap, shell, world_from_center)) return {};
  return "the scene seems to contain the part itself: every point of the part touches the scene; "
         "bake the scene --without the part, or with smaller voxels";
}

}  // namespace forcelayer

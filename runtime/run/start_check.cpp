#include "runtime/run/start_check.h"

#include <cstdio>
#include <string>
#include <vector>

#include "runtime/query/enclosed_object.h"

namespace forcelayer {

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
      " lies inside the part, at x %.2f, y %.2f, z %.2f mm, where its shell has no points",
      1e3 * p.x, 1e3 * p.y, 1e3 * p.z);
  return Error{ErrorCode::kUsage, "", "start",
               (name.empty() ? std::string("an object") : std::string(name)) + at,
               "bake the scene without it (--without), start elsewhere (--start), or run without "
               "the guarantee (--without-guarantee, without_guarantee)"};
}

std::optional<std::string> part_in_scene_warning(const Pshell& shell, std::uint64_t seat_points) {
  if (seat_points != shell.header().point_count) return {};
  return "the scene seems to contain the part itself: every point of the part touches the scene; "
         "bake the scene --without the part, or with smaller voxels";
}

}  // namespace forcelayer

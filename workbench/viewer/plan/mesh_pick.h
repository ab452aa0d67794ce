// The first place at which a ray meets the scene's meshes, or the part.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "forcelayer/pose.h"
#include "workbench/viewer/plan/view_scene.h"
#include "workbench/viewer/surface/pick.h"

namespace forcelayer::viewer {

struct MeshHit {
  std::string_view name;
  double along;  // the place is ray.from_m + along * ray.along
};

// The scene's mesh that the ray, in the world, meets first on the side that the cut leaves, of
// those that are not hidden ([meshes]).
std::optional<MeshHit> mesh_on(const ViewScene& scene, const std::vector<char>& hidden,
                               const Ray& ray, const std::optional<Cut>& cut);

// How far along the ray, in the world, it meets the part's mesh (`mesh`), or the discs of its
// shell.
std::optional<double> part_on(const ViewScene& scene, bool mesh, const Pose& world_from_part,
                              const Ray& ray);

}  // namespace forcelayer::viewer

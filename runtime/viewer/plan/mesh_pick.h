// The mesh that a ray meets first.
#pragma once

#include <string_view>
#include <vector>

#include "runtime/viewer/plan/view_scene.h"
#include "runtime/viewer/surface/pick.h"

namespace forcelayer::viewer {

// The name of the scene's mesh that the ray, in the world, meets first on the side that the cut
// leaves, of those that are not hidden ([meshes]); empty where it meets none.
std::string_view mesh_on(const ViewScene& scene, const std::vector<char>& hidden, const Ray& ray,
                         const std::optional<Cut>& cut);

}  // namespace forcelayer::viewer

#include "voxelize/warnings.h"

#include <set>

#include "formats/mesh/units.h"

namespace forcelayer::voxelize {

std::vector<std::string> all_warnings(const mesh::Scene& scene,
                                      std::span<const cache::MeshOutline> meshes,
                                      const BakeOptions& options) {
  std::vector<std::string> warnings = scene.warnings;
  std::set<std::string> coarse_files;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const mesh::MeshObject& part = scene.objects[i];
    const double spacing_m =
        mesh::vertex_spacing_m(meshes[i].float_coordinate, part.world_from_mesh);
    const auto coarse = mesh::coarse_vertices_warning(spacing_m, options.voxel_size_m);
    if (coarse && coarse_files.insert(part.file).second) {
      warnings.push_back(part.file + ": " + *coarse);
    }
  }
  return warnings;
}

}  // namespace forcelayer::voxelize

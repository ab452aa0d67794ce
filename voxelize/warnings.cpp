#include "voxelize/warnings.h"

#include <algorithm>
#include <map>

#include "formats/mesh/reader.h"
#include "formats/mesh/units.h"

namespace forcelayer::voxelize {

std::vector<std::string> all_warnings(const mesh::Scene& scene,
                                      std::span<const cache::MeshOutline> meshes,
                                      const BakeOptions& options) {
  std::vector<std::string> warnings = scene.warnings;
  if (scene.objects.size() > kMaxObjects && options.objects && stores_distances(options)) {
    warnings.push_back("the file stores no object names, because it can name at most " +
                       std::to_string(kMaxObjects) + " objects, but the scene has " +
                       std::to_string(scene.objects.size()) +
                       "; leave some objects out with --without, or join some");
  }
  std::map<std::string, double> coarse_files;  // with the widest spacing of each, meters
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const mesh::MeshObject& part = scene.objects[i];
    const double spacing_m =
        mesh::vertex_spacing_m(meshes[i].float_coordinate, part.world_from_mesh);
    if (!mesh::coarse_vertices_warning(spacing_m, options.voxel_size_m)) continue;
    double& widest_m = coarse_files[named_file(part.file).path];
    widest_m = std::max(widest_m, spacing_m);
  }
  if (coarse_files.empty()) return warnings;
  const auto [file, spacing_m] =
      *std::max_element(coarse_files.begin(), coarse_files.end(),
                        [](const auto& a, const auto& b) { return a.second < b.second; });
  std::string line = file + ": " + *mesh::coarse_vertices_warning(spacing_m, options.voxel_size_m);
  if (coarse_files.size() > 1) {
    line += " (this also applies to " + mesh::counted(coarse_files.size() - 1, "other file") + ")";
  }
  warnings.push_back(std::move(line));
  return warnings;
}

}  // namespace forcelayer::voxelize

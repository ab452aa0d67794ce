#include "voxelize/warnings.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

namespace forcelayer {
namespace {

// Longest column of the linear part: metres per unit of the mesh.
double stretch(const Affine& affine) {
  double largest = 0;
  for (std::size_t j = 0; j < 3; ++j) {
    largest =
        std::max(largest, std::hypot(affine.linear[j], affine.linear[3 + j], affine.linear[6 + j]));
  }
  return largest;
}

// Distance between neighbouring 32-bit numbers at the mesh's largest coordinate, metres.
double vertex_spacing_m(const Mesh& mesh, const Affine& world_from_mesh) {
  double largest = 0;
  for (const Vec3d& vertex : mesh.vertices) {
    for (const double x : vertex) largest = std::max(largest, std::abs(x));
  }
  return largest * static_cast<double>(std::numeric_limits<float>::epsilon()) *
         stretch(world_from_mesh);
}

}  // namespace

std::vector<std::string> all_warnings(const Scene& scene, const BakeOptions& options) {
  std::vector<std::string> warnings = scene.warnings;
  std::set<std::string> coarse_files;
  for (const ScenePart& part : scene.parts) {
    const Mesh& mesh = scene.mesh_of(part);
    if (!mesh.single_precision) continue;
    const double spacing_m = vertex_spacing_m(mesh, part.world_from_mesh);
    if (spacing_m <= options.voxel_size_m / 1000 || !coarse_files.insert(part.file).second)
      continue;
    char line[160];
    std::snprintf(line, sizeof line,
                  ": vertices are 32-bit numbers, %.2g m apart where they lie: coarser than a "
                  "thousandth of a voxel",
                  spacing_m);
    warnings.push_back(part.file + line);
  }
  return warnings;
}

}  // namespace forcelayer

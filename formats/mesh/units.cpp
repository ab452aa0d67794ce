#include "formats/mesh/units.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace forcelayer {
namespace {

std::string text_of(double number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

double largest_coordinate(const Mesh& mesh) {
  double largest = 0;
  for (const Vec3d& vertex : mesh.vertices) {
    for (const double coordinate : vertex) largest = std::max(largest, std::abs(coordinate));
  }
  return largest;
}

// How far an error of 1 along an axis of the mesh may become in the assembly.
double largest_stretch(const Affine& affine) {
  double largest = 0;
  for (std::size_t column = 0; column < 3; ++column) {
    largest = std::max(largest, std::hypot(affine.linear[column], affine.linear[column + 3],
                                           affine.linear[column + 6]));
  }
  return largest;
}

}  // namespace

Result<double> metres_per_unit(const Assembly& assembly, const std::string& path,
                               std::optional<double> chosen, std::vector<std::string>& warnings) {
  const std::optional<double>& defined = assembly.metres_per_unit;
  if (!chosen && !defined) {
    return Error{ErrorCode::kUsage, path, "", "this format does not say which unit its numbers are",
                 "give the unit with --units, such as --units mm"};
  }
  if (!chosen) return *defined;
  if (defined && *defined != *chosen) {
    warnings.push_back(path + ": its format defines a unit of " + text_of(*defined) +
                       " m; --units makes it " + text_of(*chosen) + " m");
  }
  return *chosen;
}

double float_spacing(double coordinate) {
  constexpr int kMantissaBits = 23, kLowestExponent = -126;
  if (coordinate == 0) return 0;
  return std::ldexp(1.0, std::max(std::ilogb(coordinate), kLowestExponent) - kMantissaBits);
}

double vertex_spacing_m(const Assembly& assembly, double metres_per_unit) {
  std::vector<double> spacing(assembly.meshes.size(), 0);  // mesh frame, file units
  for (std::size_t i = 0; i < assembly.meshes.size(); ++i) {
    const Mesh& mesh = assembly.meshes[i];
    if (mesh.single_precision) spacing[i] = float_spacing(largest_coordinate(mesh));
  }
  double coarsest = 0;
  for (const MeshInstance& instance : assembly.instances) {
    coarsest =
        std::max(coarsest, spacing[instance.mesh] * largest_stretch(instance.assembly_from_mesh));
  }
  return coarsest * metres_per_unit;
}

void warn_of_coarse_vertices(const Assembly& assembly, const std::string& path,
                             double metres_per_unit, double voxel_size_m,
                             std::vector<std::string>& warnings) {
  const double spacing_m = vertex_spacing_m(assembly, metres_per_unit);
  if (!(spacing_m > voxel_size_m / 1000)) return;
  warnings.push_back(path + ": its 32-bit vertices lie " + text_of(spacing_m) +
                     " m apart at the least where they are, more than a thousandth of a voxel; "
                     "move the mesh towards its origin before exporting it");
}

}  // namespace forcelayer

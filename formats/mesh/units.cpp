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

}  // namespace

Result<double> metres_per_unit(const Assembly& assembly, const std::string& path,
                               std::optional<double> chosen, std::vector<std::string>& warnings) {
  const std::optional<double>& defined = assembly.metres_per_unit;
  if (!chosen && !defined) {
    return Error{ErrorCode::kUsage, path, "", "this format does not say which unit its numbers are",
                 "add --units, for example --units mm, or units in the manifest"};
  }
  if (!chosen) return *defined;
  if (defined && *defined != *chosen) {
    warnings.push_back(path + ": its format defines a unit of " + text_of(*defined) +
                       " m; the given unit makes it " + text_of(*chosen) + " m");
  }
  return *chosen;
}

double float_spacing(double coordinate) {
  constexpr int kMantissaBits = 23, kLowestExponent = -126;
  if (coordinate == 0) return 0;
  return std::ldexp(1.0, std::max(std::ilogb(coordinate), kLowestExponent) - kMantissaBits);
}

double largest_stretch(const Affine& a_from_b) {
  const auto& linear = a_from_b.linear;
  double largest = 0;
  for (std::size_t column = 0; column < 3; ++column) {
    largest = std::max(largest, std::hypot(linear[column], linear[column + 3], linear[column + 6]));
  }
  return largest;
}

double float_coordinate(const Mesh& mesh) {
  if (!mesh.single_precision) return 0;
  double largest = 0;
  for (const Vec3d& vertex : mesh.vertices) {
    for (const double coordinate : vertex) largest = std::max(largest, std::abs(coordinate));
  }
  return largest;
}

double vertex_spacing_m(double float_coordinate, const Affine& world_from_mesh) {
  return float_spacing(float_coordinate) * largest_stretch(world_from_mesh);
}

std::optional<std::string> coarse_vertices_warning(double spacing_m, double voxel_size_m) {
  if (!(spacing_m > voxel_size_m / 1000)) return std::nullopt;
  return "its 32-bit vertices lie " + text_of(spacing_m) +
         " m apart where they are, more than a thousandth of a voxel; move the mesh towards its "
         "origin before exporting it";
}

}  // namespace forcelayer

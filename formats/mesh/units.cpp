#include "formats/mesh/units.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "formats/command/quantity.h"
#include "formats/command/text.h"

namespace forcelayer::mesh {
namespace {

std::string text_of(double number) {
  std::ostringstream text;
  text << number;
  return text.str();
}

// "1 mm"; "0.5 m" where that is no unit.
std::string length_text(double meters) {
  for (const char* const name : {"nm", "um", "mm", "cm", "dm", "m", "km", "in", "ft", "yd"}) {
    const auto unit = command::parse_unit(name);
    if (unit && *unit == meters) return std::string("1 ") + name;
  }
  return text_of(meters) + " m";
}

}  // namespace

Result<double> meters_per_unit(const Assembly& assembly, const std::string& path,
                               std::optional<double> chosen, std::vector<std::string>& warnings) {
  const std::optional<double>& defined = assembly.meters_per_unit;
  if (!chosen && !defined) {
    return Error{ErrorCode::kUsage, path, "", "this file format does not state the unit of length",
                 "add --units, for example --units mm"};
  }
  if (!chosen) return *defined;
  if (defined && *defined != *chosen) {
    warnings.push_back(length_text(*defined) + " of the file is read as " + length_text(*chosen) +
                       ", as you asked");
  }
  return *chosen;
}

double float_spacing(double coordinate) {
  constexpr int kMantissaBits = 23, kLowestExponent = -126;
  if (coordinate == 0) return 0;
  return std::ldexp(1.0, std::max(std::ilogb(coordinate), kLowestExponent) - kMantissaBits);
}

// The largest singular value: the root of the largest eigenvalue of A^T A, in closed form (Smith
// 1961, "Eigenvalues of a symmetric 3 x 3 matrix").
double largest_stretch(const Affine& a_from_b) {
  const auto& linear = a_from_b.linear;
  double scale = 0;  // so that squares neither overflow nor vanish
  for (const double x : linear) scale = std::max(scale, std::abs(x));
  if (scale == 0) return 0;
  double m[3][3] = {};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::size_t k = 0; k < 9; k += 3)
        m[i][j] += linear[k + i] / scale * (linear[k + j] / scale);
    }
  }
  const double mean = (m[0][0] + m[1][1] + m[2][2]) / 3;
  const double off = m[0][1] * m[0][1] + m[0][2] * m[0][2] + m[1][2] * m[1][2];
  const double a = m[0][0] - mean, b = m[1][1] - mean, c = m[2][2] - mean;
  const double spread = std::sqrt((a * a + b * b + c * c + 2 * off) / 6);
  if (spread == 0) return scale * std::sqrt(mean);
  const double determinant = a * (b * c - m[1][2] * m[1][2]) -
                             m[0][1] * (m[0][1] * c - m[1][2] * m[0][2]) +
                             m[0][2] * (m[0][1] * m[1][2] - b * m[0][2]);
  const double cosine = std::clamp(determinant / (2 * spread * spread * spread), -1.0, 1.0);
  const double largest = mean + 2 * spread * std::cos(std::acos(cosine) / 3);
  return scale * std::sqrt(largest) * (1 + 1e-12);  // above the rounding of these steps
}

// The columns of the cofactor matrix are the images of unit areas across the axes. The least factor
// of any area is the product of the two smaller singular values.
AreaFactors area_factors(const Affine& a_from_b) {
  const double stretch = largest_stretch(a_from_b);
  if (stretch == 0) return {};
  std::array<double, 9> m = a_from_b.linear;
  for (double& x : m) x /= stretch;  // so that products neither overflow nor vanish
  const auto across = [&](std::size_t i, std::size_t j) {
    return Vec3d{m[3 + i] * m[6 + j] - m[6 + i] * m[3 + j], m[6 + i] * m[j] - m[i] * m[6 + j],
                 m[i] * m[3 + j] - m[3 + i] * m[j]};
  };
  const Vec3d x = across(1, 2), y = across(2, 0), z = across(0, 1);
  const auto length = [](const Vec3d& v) { return std::hypot(v[0], v[1], v[2]); };
  const double determinant = m[0] * x[0] + m[3] * x[1] + m[6] * x[2];
  const double square = stretch * stretch;
  return {square * std::abs(determinant), square * (length(x) + length(y) + length(z)) / 3};
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
  const auto& linear = world_from_mesh.linear;
  double longest = 0;  // of the images of the mesh's axes
  for (std::size_t column = 0; column < 3; ++column) {
    longest = std::max(longest, std::hypot(linear[column], linear[column + 3], linear[column + 6]));
  }
  return float_spacing(float_coordinate) * longest;
}

std::optional<std::string> coarse_vertices_warning(double spacing_m, double voxel_size_m) {
  if (!(spacing_m > voxel_size_m / 1000)) return std::nullopt;
  return "the 32-bit coordinates are rounded to steps of " + text_of(spacing_m) +
         " m, which is more than a thousandth of a voxel; move the mesh nearer to the origin "
         "before you export it";
}

std::optional<std::string> small_size_warning(const std::string& what, const Box& box_m,
                                              double voxel_size_m) {
  constexpr double kFewVoxels = 4;
  double across_m = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    across_m = std::max(across_m, box_m.high[axis] - box_m.low[axis]);
  }
  const double voxels = across_m / voxel_size_m;
  if (!(across_m > 0 && voxels < kFewVoxels)) return std::nullopt;
  return what + command::text(" is %.3g mm across, ", 1e3 * across_m) +
         (voxels < 1 ? "less than a voxel" : command::text("%.2g voxels", voxels)) +
         ": check --units; if the unit is right, use a smaller --voxel-size";
}

}  // namespace forcelayer::mesh

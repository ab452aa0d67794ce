// The unit of a mesh file, and whether its vertices are stored finely enough.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/result.h"

namespace forcelayer::mesh {

// Meters per unit of `assembly`, read from `path`. `chosen` is what --units says, in meters; it is
// required (else kUsage) unless the file defines its unit, and overrides that with a warning
// (without the path).
Result<double> meters_per_unit(const Assembly& assembly, const std::string& path,
                               std::optional<double> chosen, std::vector<std::string>& warnings);

// Distance between neighboring 32-bit floats at `coordinate`; 0 at 0.
double float_spacing(double coordinate);

// The greatest length in a of a unit vector of b: the largest singular value, rounded up.
double largest_stretch(const Affine& a_from_b);

// By how much it makes areas larger: no surface less than `smallest`, a cube's `mean`. Both are the
// square of the scale where that is even.
struct AreaFactors {
  double smallest = 0, mean = 0;
};
AreaFactors area_factors(const Affine& a_from_b);

// The largest |coordinate| of a mesh whose vertices are stored as 32-bit floats, else 0.
double float_coordinate(const Mesh& mesh);

// Distance along an axis of the mesh between neighboring 32-bit floats at such a coordinate, in
// meters after `world_from_mesh`.
double vertex_spacing_m(double float_coordinate, const Affine& world_from_mesh);

// The warning for a spacing of more than a thousandth of a voxel; nothing for a finer one.
std::optional<std::string> coarse_vertices_warning(double spacing_m, double voxel_size_m);

// The warning for what is less than four voxels across, `what` being "the scene": the likeliest
// mistake is millimeters that are meters. Nothing for a larger box, or an empty one.
std::optional<std::string> small_size_warning(const std::string& what, const Box& box_m,
                                              double voxel_size_m);

}  // namespace forcelayer::mesh

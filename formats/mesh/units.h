// Which length a number in a mesh file stands for, and whether its vertices are fine enough.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/mesh/mesh.h"
#include "formats/result.h"

namespace forcelayer {

// Metres per unit of `assembly`, read from `path`. `chosen` is what --units says, in metres; it is
// required (else kUsage) unless the file defines its unit, and overrides that with a warning.
Result<double> metres_per_unit(const Assembly& assembly, const std::string& path,
                               std::optional<double> chosen, std::vector<std::string>& warnings);

// Distance between neighbouring 32-bit floats at `coordinate`; 0 at 0.
double float_spacing(double coordinate);

// The coarsest spacing, in metres in the assembly's frame, of the 32-bit vertices of `assembly`
// where they lie; 0 where none are stored as 32-bit floats.
double vertex_spacing_m(const Assembly& assembly, double metres_per_unit);

// Adds a warning where that is more than a thousandth of a voxel.
void warn_of_coarse_vertices(const Assembly& assembly, const std::string& path,
                             double metres_per_unit, double voxel_size_m,
                             std::vector<std::string>& warnings);

}  // namespace forcelayer

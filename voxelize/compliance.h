// --compliance: the pressure of a soft surface over its depth, as the user gives it and as a file
// stores it (formats/voxmap_format.md, section 6).
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "formats/result.h"

namespace forcelayer::voxelize {

// A corner of the curve, which runs straight from no pressure at no depth to the first corner, and
// from corner to corner.
struct CompliancePoint {
  double depth_m = 0;
  double pressure_pa = 0;
};
using Compliance = std::vector<CompliancePoint>;  // depths ascending

// "2mm:5kPa,6mm:40kPa". Errors: kUsage.
Result<Compliance> parse_compliance(std::string_view text);

// Whether a file may hold the curve: depths ascend from above 0, pressures do not decrease and stay
// below 1 GPa and 1e15 Pa/m. Errors: kUsage.
Status check_compliance(std::span<const CompliancePoint> curve);

// Pressures at depths of 0, 1, 2, ... times `step_m`, up to the first at or beyond the last corner.
std::vector<float> compliance_table(std::span<const CompliancePoint> curve, double step_m);

}  // namespace forcelayer::voxelize

// --compliance: the force of a contact point over its depth, as the user gives it and as a file
// stores it (formats/voxmap_format.md, section 6).
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "formats/result.h"

namespace forcelayer::voxelize {

// A corner of the curve, which runs straight from no force at no depth to the first corner, and
// from corner to corner.
struct CompliancePoint {
  double depth_m = 0;
  double force_n = 0;
};
using Compliance = std::vector<CompliancePoint>;  // depths ascending

// "2mm:0.5N,6mm:4N". Errors: kUsage.
Result<Compliance> parse_compliance(std::string_view text);

// Whether a file may hold the curve: depths ascend from above 0, forces do not decrease and stay
// below 1e6 N and 1e12 N/m. Errors: kUsage.
Status check_compliance(std::span<const CompliancePoint> curve);

// Forces at depths of 0, 1, 2, ... times `step_m`, up to the first at or beyond the last corner.
std::vector<float> compliance_table(std::span<const CompliancePoint> curve, double step_m);

}  // namespace forcelayer::voxelize

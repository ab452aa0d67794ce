// The clearance curve of voxcheck as a picture.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "formats/result.h"

namespace forcelayer::study {

// SVG: what is proven along the path, as `curve`, the CSV of voxcheck, has it; what is required,
// the seat, violations and the least clearance from its report, `verdict`.
Result<std::string> curve_svg(const std::string& curve, const nlohmann::json& verdict);

}  // namespace forcelayer::study

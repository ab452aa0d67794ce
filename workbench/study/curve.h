// The clearance curve of voxcheck as a picture.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "formats/result.h"

namespace forcelayer::study {

// A piece of the curve, and the clearance that is proven for all of it.
struct CurvePiece {
  double from_s = 0, to_s = 0, clearance_m = 0;
  double from_m = 0, to_m = 0;  // positions along the path
};

// The CSV that voxcheck wrote: at least one piece. Errors: kReadFailed.
Result<std::vector<CurvePiece>> read_curve(const std::string& path);

// SVG: what is proven along the path, as `curve`, the CSV of voxcheck, has it; what is required,
// the seat, violations and the least clearance from its report, `verdict`. Attributes say where the
// axes are, for scripts.
Result<std::string> curve_svg(const std::string& curve, const nlohmann::json& verdict);

}  // namespace forcelayer::study

#include "voxelize/compliance.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "formats/command/quantity.h"
#include "formats/voxmap_format.h"

namespace forcelayer::voxelize {
namespace {

constexpr double kRounding = 1e-12;      // tolerance of the last corner's depth
constexpr double kMinPressurePa = 1e-3;  // of the last corner: less counts as none

Error wrong(std::string what, std::string mend) {
  return {ErrorCode::kUsage, "", "--compliance", std::move(what), std::move(mend)};
}

Result<CompliancePoint> parse_corner(std::string_view text) {
  const auto colon = text.find(':');
  if (colon == std::string_view::npos) {
    return wrong("'" + std::string(text) + "' is not DEPTH:PRESSURE", "write for example 2mm:5kPa");
  }
  const auto depth = command::parse_length(text.substr(0, colon));
  if (!depth) return wrong(depth.error().what, depth.error().mend);
  const auto pressure = command::parse_pressure_pa(text.substr(colon + 1));
  if (!pressure) return wrong(pressure.error().what, pressure.error().mend);
  return CompliancePoint{*depth, *pressure};
}

}  // namespace

Result<Compliance> parse_compliance(std::string_view text) {
  Compliance curve;
  for (;;) {
    const auto comma = text.find(',');
    const auto corner = parse_corner(text.substr(0, comma));
    if (!corner) return corner.error();
    curve.push_back(*corner);
    if (comma == std::string_view::npos) break;
    text.remove_prefix(comma + 1);
  }
  if (Status checked = check_compliance(curve); !checked) return checked.error();
  return curve;
}

Status check_compliance(std::span<const CompliancePoint> curve) {
  CompliancePoint last;
  for (const CompliancePoint& point : curve) {
    if (!(point.depth_m > last.depth_m) || !std::isfinite(point.depth_m)) {
      return wrong("has depths that are not above 0, or do not ascend", "list the pairs by depth");
    }
    const double rise_pa = point.pressure_pa - last.pressure_pa;
    if (!(rise_pa >= 0 && point.pressure_pa <= double{kMaxCompliancePa})) {
      return wrong("has a pressure that is below the pressure before it, or above 1 GPa",
                   "the pressure of a soft surface must not decrease with depth");
    }
    if (!(rise_pa <= kMaxCompliancePaPerM * (point.depth_m - last.depth_m))) {
      return wrong("rises by more than 1e15 Pa/m", "");
    }
    last = point;
  }
  if (!curve.empty() && !(last.pressure_pa >= kMinPressurePa)) {
    return wrong("has no pressure at any depth", "leave it out, or raise the last pressure");
  }
  return {};
}

std::vector<float> compliance_table(std::span<const CompliancePoint> curve, double step_m) {
  std::vector<float> table;
  CompliancePoint from;
  for (std::size_t i = 0, corner = 0; corner < curve.size(); ++i) {
    const double depth_m = static_cast<double>(i) * step_m;
    while (corner < curve.size() && curve[corner].depth_m < depth_m) from = curve[corner++];
    const CompliancePoint& to = corner < curve.size() ? curve[corner] : curve.back();
    const double fraction =
        corner < curve.size() ? (depth_m - from.depth_m) / (to.depth_m - from.depth_m) : 1;
    const auto pressure_pa =
        static_cast<float>(from.pressure_pa + fraction * (to.pressure_pa - from.pressure_pa));
    table.push_back(table.empty() ? pressure_pa : std::max(pressure_pa, table.back()));
    if (depth_m >= curve.back().depth_m * (1 - kRounding)) break;
  }
  return table;
}

}  // namespace forcelayer::voxelize

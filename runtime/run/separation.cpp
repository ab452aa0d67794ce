#include "runtime/run/separation.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace forcelayer {
namespace {

std::optional<double> positive(double bound_m) {
  return bound_m > 0 ? std::optional<double>(bound_m) : std::nullopt;
}

// How far the arc of a point deviates from its chord when nothing travels more than s/2: a point at
// radius r that turns by a deviates by r (1 - cos(a/2)), at most r a^2 / 8 and at most 2r, and the
// part's radius R gives R a <= s/2.
double arc_deviation_m(double voxel_size_m, double radius_m) {
  if (!(radius_m > 0)) return 0;
  return std::min(voxel_size_m * voxel_size_m / (32 * radius_m), 2 * radius_m);
}

// Three digits, rounded down: a guarantee must not be quoted larger than it is.
std::string length_text(const std::optional<double>& length_m) {
  if (!length_m) return "none";
  const double length_mm = *length_m * 1000;
  const double last_digit = std::pow(10, std::floor(std::log10(length_mm)) - 2);
  char text[32];
  std::snprintf(text, sizeof text, "%.3g mm", std::floor(length_mm / last_digit) * last_digit);
  return text;
}

}  // namespace

SeparationGuarantee separation_guarantee(const VoxmapHeader& voxmap, const PshellHeader& shell,
                                         double pose_error_m) {
  if (voxmap.offset_layers < 2) return {};
  const double s = voxmap.voxel_size_m;
  const double layers = voxmap.offset_layers - 1.0;
  const double spent_m =
      shell.covering_radius_m + voxmap.static_deviation_m + shell.part_deviation_m + pose_error_m;
  // Half-way along a chord of s/2 a point is s/4 from either end.
  const double chord_m = std::sqrt(layers * layers - 1.0 / 16) * s;
  return {positive(layers * s - spent_m),
          positive(chord_m - spent_m - arc_deviation_m(s, shell.bounding_radius_m))};
}

std::string guarantee_text(const SeparationGuarantee& guarantee) {
  return length_text(guarantee.tested_m) + " at every frame, " + length_text(guarantee.swept_m) +
         " between frames whose points travel at most half a voxel";
}

Status require_guarantee(const SeparationGuarantee& guarantee, const std::string& part) {
  if (guarantee.tested_m && guarantee.swept_m) return {};
  return Error{ErrorCode::kFilesDoNotMatch, part, "",
               "no separation is guaranteed with this scene (" + guarantee_text(guarantee) + ")",
               "bake the scene with two layers or more or the part with a smaller "
               "--covering-radius, or run without (--without-guarantee, without_guarantee)"};
}

}  // namespace forcelayer

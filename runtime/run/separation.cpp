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
  if (!(length_mm > 0)) return "0 mm";
  const double last_digit = std::pow(10, std::floor(std::log10(length_mm)) - 2);
  char text[32];
  std::snprintf(text, sizeof text, "%.3g mm", std::floor(length_mm / last_digit) * last_digit);
  return text;
}

// The same as an option takes it.
std::string option_text(double length_m) {
  std::string text = length_text(length_m);
  std::erase(text, ' ');
  return text;
}

double chord_m(const VoxmapHeader& voxmap) {
  const double layers = voxmap.offset_layers - 1.0;
  // Half-way along a chord of s/2 a point is s/4 from either end.
  return std::sqrt(layers * layers - 1.0 / 16) * voxmap.voxel_size_m;
}

// The fewest layers that leave something when this length, in voxels, is spent.
std::string layers_text(double spent_voxels) {
  constexpr double kMaxLayers = 30;  // that voxelize bakes
  const double layers = std::floor(std::hypot(spent_voxels, 0.25)) + 2;
  if (!(layers <= kMaxLayers)) return "bake scene and part with larger voxels";
  return "bake the scene with --layers " + std::to_string(static_cast<int>(layers));
}

// The least standoff at which the guard's distance leaves something between frames.
std::string standoff_text(const VoxmapHeader& voxmap, double pose_error_m, double arc_m,
                          double part_deviation_m, const DistanceGuard& guard) {
  constexpr double kAboveNothing = 0.01;  // voxels: more than the rounding of the text
  const double s = voxmap.voxel_size_m;
  const double spent_m = voxmap.static_deviation_m + part_deviation_m + pose_error_m;
  const double between_m =
      min_point_distance_for_m(guard.shell, spent_m + kAboveNothing * s) + arc_m;
  const double guard_m = std::hypot(between_m, 0.25 * s);
  const double standoff_m = voxmap.zero_force_m + std::max(0.0, guard_m - guard.distance_m);
  char text[64];
  std::snprintf(text, sizeof text, "--standoff %.4gmm", standoff_m * 1000 + 5e-4 * s * 1000);
  return text;
}

// Says how to get a guarantee. A smaller covering radius is no help where the deviations alone are
// too much.
std::string advice(const VoxmapHeader& voxmap, const PshellHeader& shell, double pose_error_m,
                   const DistanceGuard& guard) {
  constexpr double kBelowRoom = 0.9;  // of what would leave nothing
  const double s = voxmap.voxel_size_m;
  if (has_standoff(voxmap)) {
    if (!(guard.distance_m > 0)) {
      return "leave out --model and --force, because with a standoff only the distance field keeps "
             "the guarantee";
    }
    const double arc_m = arc_deviation_m(s, shell.bounding_radius_m);
    return "bake the scene with " +
           standoff_text(voxmap, pose_error_m, arc_m, shell.part_deviation_m, guard) +
           " or more, or the part with a smaller --covering-radius";
  }
  const double deviations_m = voxmap.static_deviation_m + shell.part_deviation_m;
  const double given_m = deviations_m + pose_error_m + arc_deviation_m(s, shell.bounding_radius_m);
  const std::string more_layers = layers_text((given_m + shell.covering_radius_m) / s);
  if (voxmap.offset_layers < 2) return more_layers;
  const double room_m = chord_m(voxmap) - given_m;
  if (room_m > 0.1 * s) {
    return "bake the part with --covering-radius " + option_text(kBelowRoom * room_m) +
           " or less, or " + more_layers;
  }
  return more_layers + ", or bake both from more exact meshes: the scene's meshes deviate by " +
         length_text(voxmap.static_deviation_m) + " and the part's meshes by " +
         length_text(shell.part_deviation_m) + ", including --mesh-deviation";
}

}  // namespace

SeparationGuarantee separation_guarantee(const VoxmapHeader& voxmap, const PshellHeader& shell,
                                         double pose_error_m, const DistanceGuard& guard) {
  const double s = voxmap.voxel_size_m;
  const double deviations_m = voxmap.static_deviation_m + shell.part_deviation_m + pose_error_m;
  const double arc_m = arc_deviation_m(s, shell.bounding_radius_m);
  double tested_m = 0, swept_m = 0;
  if (voxmap.offset_layers >= 2) {
    tested_m = (voxmap.offset_layers - 1.0) * s - shell.covering_radius_m;
    swept_m = chord_m(voxmap) - arc_m - shell.covering_radius_m;
  }
  const double g = guard.distance_m;
  if (g > 0.25 * s) {
    const double between_m = std::max(0.0, std::sqrt(g * g - s * s / 16) - arc_m);
    tested_m = std::max(tested_m, surface_distance_bound_m(guard.shell, g));
    swept_m = std::max(swept_m, surface_distance_bound_m(guard.shell, between_m));
  }
  return {positive(tested_m - deviations_m), positive(swept_m - deviations_m)};
}

std::string guarantee_text(const SeparationGuarantee& guarantee) {
  return length_text(guarantee.tested_m) + " at every frame, " + length_text(guarantee.swept_m) +
         " between frames if points travel at most half a voxel";
}

Status require_guarantee(const VoxmapHeader& voxmap, const PshellHeader& shell, double pose_error_m,
                         const DistanceGuard& guard, const std::string& part) {
  const SeparationGuarantee guarantee = separation_guarantee(voxmap, shell, pose_error_m, guard);
  if (guarantee.tested_m && guarantee.swept_m) return {};
  return Error{ErrorCode::kFilesDoNotMatch, part, "",
               "no separation is guaranteed with this scene (" + guarantee_text(guarantee) + ")",
               advice(voxmap, shell, pose_error_m, guard) +
                   ", or use --without-guarantee (in code: without_guarantee)"};
}

}  // namespace forcelayer

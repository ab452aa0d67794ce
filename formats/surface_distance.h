// From the distance of shell points to the distance of the part's whole surface (pshell_format.md,
// section 4).
#pragma once

#include <span>

#include "formats/pshell_format.h"

namespace forcelayer {

// The bounds that a .pshell proves for its part's surface. Pshell::surface_distance_terms() fills
// them in.
struct SurfaceDistanceTerms {
  double covering_radius_m = 0;  // rho
  double convex_radius_m = 0;    // rho_h
  double convex_gap_m = 0;       // delta
  std::span<const DistanceLoss> losses;
};

// The largest lower bound, m, for the distance between the part's outer surface and any scene that
// every shell point is at least `min_point_distance_m` (finite) away from. Never negative; never
// falls while the argument grows. The scene's and the part's deviations and the rounding of the
// pose come off this.
double surface_distance_bound_m(const SurfaceDistanceTerms& terms, double min_point_distance_m);

// The least distance of all shell points, m, that proves `surface_distance_m` (finite, positive or
// zero) for the whole surface: surface_distance_bound_m() of the result is no smaller.
double min_point_distance_for_m(const SurfaceDistanceTerms& terms, double surface_distance_m);

}  // namespace forcelayer

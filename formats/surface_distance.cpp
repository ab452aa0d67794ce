#include "formats/surface_distance.h"

#include <algorithm>
#include <cmath>

namespace forcelayer {
namespace {

// A fraction of distances, and of squared distances under a root, that exceeds the rounding of this
// file. min_point_distance_for_m() adds it twice, so that its result proves what is wanted.
constexpr double kRounding = 0x1p-46;

double square(double x) { return x * x; }

// sqrt(squared less `margin`), or 0 where that does not exist.
double lowered_root(double squared, double margin) {
  return squared > margin ? std::sqrt(squared - margin) : 0;
}

double proven_distance(const DistanceLoss& entry) { return entry.distance_m - entry.loss_m; }

// m_i^2 - (m_i - L_i)^2: what an entry takes from the square of a smaller distance.
double squared_loss(const DistanceLoss& entry) {
  return entry.loss_m * (entry.distance_m + proven_distance(entry));
}

double bound_by(const DistanceLoss& entry, double m) {
  if (m >= entry.distance_m) return m - entry.loss_m;
  return lowered_root(square(m) - squared_loss(entry), kRounding * square(entry.distance_m));
}

double needed_by(const DistanceLoss& entry, double wanted) {
  if (wanted >= proven_distance(entry)) return wanted + entry.loss_m;
  return std::sqrt(square(wanted) + squared_loss(entry) + 2 * kRounding * square(entry.distance_m));
}

double largest_length(const SurfaceDistanceTerms& terms, double distance) {
  double largest = std::max({distance, terms.covering_radius_m, terms.convex_radius_m});
  for (const DistanceLoss& entry : terms.losses) largest = std::max(largest, entry.distance_m);
  return largest;
}

}  // namespace

double surface_distance_bound_m(const SurfaceDistanceTerms& terms, double min_point_distance_m) {
  const double m = std::max(0.0, min_point_distance_m);
  double bound = m - terms.covering_radius_m;
  if (m >= terms.convex_radius_m) {
    const double root =
        lowered_root(square(m) - square(terms.convex_radius_m), kRounding * square(m));
    bound = std::max(bound, root - terms.convex_gap_m);
  }
  for (const DistanceLoss& entry : terms.losses) bound = std::max(bound, bound_by(entry, m));
  return std::max(0.0, bound - kRounding * largest_length(terms, m));
}

double min_point_distance_for_m(const SurfaceDistanceTerms& terms, double surface_distance_m) {
  const double wanted =
      surface_distance_m + 2 * kRounding * largest_length(terms, surface_distance_m);
  const double root = wanted + terms.convex_gap_m;
  const double squared = square(root) + square(terms.convex_radius_m);
  double smallest =
      std::min(wanted + terms.covering_radius_m, std::sqrt(squared * (1 + 2 * kRounding)));
  for (const DistanceLoss& entry : terms.losses)
    smallest = std::min(smallest, needed_by(entry, wanted));
  return smallest * (1 + kRounding);
}

}  // namespace forcelayer

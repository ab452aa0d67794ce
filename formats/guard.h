// How near the guard of the default model lets a part come, by what a .vox states: the gaps that a
// part passes and the separation that is proven while it does.
#pragma once

#include <algorithm>
#include <cmath>

#include "formats/voxmap_format.h"

namespace forcelayer {
namespace guard {

// How far behind the force layer the guard holds points, in voxels.
inline constexpr double kGuardVoxels = 0.2;

// Half the diagonal of a voxel, and the usual covering radius.
inline const double kHalfDiagonalVoxels = std::sqrt(3.0) / 2;

// The writer's error of a code, and the rounding of the run-time arithmetic.
inline constexpr double kErrorVoxels = 0.002 + 1e-4;

// The distance from one plane at which the proven distance is at least `smallest`, in voxels,
// wherever the point lies between the centers. With t_a its place between them along axis a, n the
// plane's unit normal and d its true distance, the weighted mean of the squared distances of the
// centers is d^2 + sum_a n_a^2 t_a (1 - t_a). The codes stand for up to a step less. So the proven
// distance is at least
//   sqrt((sqrt(d^2 + sum_a n_a^2 t_a (1 - t_a)) - step)^2 - sum_a t_a (1 - t_a)),
// which is least where all t_a are 1/2: sums of 1/4 and 3/4, whatever the normal.
inline double surely_proven_from(double smallest, double step) {
  const double mean = step + std::sqrt(smallest * smallest + 0.75);
  return std::sqrt(mean * mean - 0.25);
}

// The distance from one plane from which on no point is in a voxel of values 1 and 2.
inline double outside_force_from(const VoxmapHeader& h) {
  const double diagonal = 2 * kHalfDiagonalVoxels;
  if (h.metric == static_cast<std::uint32_t>(Metric::kEuclidean)) {
    // The last voxel of the force layer touches, corner by corner, one that is nearer than R.
    return interior_radius_m(h) / h.voxel_size_m + kHalfDiagonalVoxels +
           force_layers(force_layer_voxels(h)) * diagonal;
  }
  return (h.offset_layers + 1) * diagonal;  // it differs from one of the plane by k along each axis
}

}  // namespace guard

// The proven distance from the static mesh below which the guard lets no shell point go: a fifth of
// a voxel behind the force layer. 0 in maps without stored distances.
inline double guard_distance_m(const VoxmapHeader& header) {
  if (!has_distances(header)) return 0;
  return interior_radius_m(header) - guard::kGuardVoxels * header.voxel_size_m;
}

// The narrowest gap that a part surely passes, less the part's thickness, m: between parallel
// planes in any direction, wherever they lie on the lattice, and the part parallel to them. There
// is no force in its middle, and the guard lets every point be there. The part is two voxels thick
// or more, so that what is stored beside either plane is that plane's distance. A hand pushes a
// part through a somewhat narrower one.
inline double passed_gap_m(const VoxmapHeader& header) {
  const double s = header.voxel_size_m;
  double each = std::max(header.zero_force_m / s, guard::outside_force_from(header));
  if (has_distances(header)) {
    each = std::max(header.zero_force_m / s,
                    guard::surely_proven_from(guard_distance_m(header) / s,
                                              header.distance_quantum_m / s + guard::kErrorVoxels));
  }
  return 2 * each * s;
}

// The separation that is proven meanwhile, between frames too, m, for a shell of pointshell's usual
// covering radius of sqrt(3)/2 voxels that deviates nowhere; 0 for none. A shell proves this or
// more (pshell_format.md, section 4). The deviation of the scene is taken off; that of the part, of
// its pose and of arcs from their chords is not.
inline double usual_separation_m(const VoxmapHeader& header) {
  const double s = header.voxel_size_m, k = header.offset_layers;
  double smallest = guard_distance_m(header) / s;  // of a shell point from the mesh
  if (k >= 2) smallest = std::max(smallest, k - 1);
  if (!(smallest > 0.25)) return 0;
  // Between two frames a point goes half a voxel at most; half-way it is a quarter from either end.
  const double between = std::sqrt(smallest * smallest - 1.0 / 16);
  return std::max(0.0, (between - guard::kHalfDiagonalVoxels) * s - header.static_deviation_m);
}

}  // namespace forcelayer

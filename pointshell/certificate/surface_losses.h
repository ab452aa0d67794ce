// The proof of what a shell's points prove about the whole surface.
//
// For every surface place q some convex combination c of shell points has a known second moment
// about itself and a known gap |q - c|, so where every shell point is at least m from a scene, q is
// at least m less distance_loss(m, second moment, gap) from it (pshell_format.md, section 4). The
// proof finds combinations for the corners of convex pieces of surface. Between the corners both
// the place and the combination run linearly. So, for a piece and any place o, the gap is at most
// the corners' largest, and the second moment at most the largest of theirs plus |c - o|^2; a loss
// is convex in both, so it is at most the largest at a corner. This holds for the hull of any
// corners, so a box stands for all surface inside. Pieces are bisected until that is small enough.
// Nothing is sampled.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "formats/surface_distance.h"
#include "pointshell/certificate/certificate.h"
#include "pointshell/part/parallel.h"
#include "pointshell/part/part.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::certificate {

class HiddenSurface;

// The points of a part, both relative to the same center, whose balls of `radius` (m) are proven to
// cover it.
struct CoveredPart {
  const part::Part& part;
  std::span<const part::Vec3> points;
  double radius;
  double voxel_size;                      // m, of the scenes that the shell is for
  const HiddenSurface* hidden = nullptr;  // surface that it proves to be hidden does not count
  // m. What is proven holds as well where points, surface and distances are off by this together.
  double slack = 0;
};

// The distance of points, m, at which combinations are sought and corners are filled.
double aimed_distance(const CoveredPart& covered);

// The pieces of surface with a corner whose loss at aimed_distance() is above `limit` (m); `from`
// are those of an earlier search with fewer points, and nothing is looked at beyond them.
std::vector<Hole> places_above_loss(const CoveredPart& covered, double limit,
                                    const part::Progress& progress);
std::vector<Hole> places_above_loss(const CoveredPart& covered, double limit,
                                    std::span<const Hole> from);

// The losses that the points are proven to have. `losses`, radius and gap need not be optimal.
struct SurfaceLosses {
  double convex_radius = 0, convex_gap = 0;  // m, rho_h and delta
  std::vector<DistanceLoss> losses;
  std::uint64_t pieces = 0;
};
SurfaceLosses find_losses(const CoveredPart& covered, const part::Progress& progress);

// A place where claimed losses are not proven.
struct LossProof {
  bool proven = false;
  part::Vec3 open;  // a corner of a piece that is not proven
  std::uint64_t pieces = 0;
};

// Proves losses that a file claims, at least as large as those of find_losses().
LossProof prove_losses(const CoveredPart& covered, const SurfaceDistanceTerms& claimed);

}  // namespace forcelayer::certificate

// The proof that every surface point of a part lies within a radius of some shell point.
//
// Every triangle is cut into convex pieces until each has all of its corners within the radius of
// one common shell point. A ball is convex, so it then holds the whole piece. No sampling is
// involved, and rounding is accounted for: the proof is carried out at a radius that is smaller by
// more than all errors of the arithmetic together (proof_margin).
//
// Cuts run along the planes halfway between two points. After a few cuts each piece lies in the
// Voronoi cell of one point, so a piece that is not proven has a corner that is farther than the
// radius from every point. Surface that lies inside another body of the part need not be covered
// (HiddenSurface): an open piece is cut further until it is proven to lie inside, or until it is
// too small.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pointshell/part/part.h"
#include "pointshell/part/vec3.h"

namespace forcelayer::certificate {

class HiddenSurface;

// A piece of the surface where the proof failed.
struct Hole {
  part::Vec3 position;  // the corner that is farthest from all points
  double distance = 0;  // m, from there to the nearest point; a lower bound where no point is near
  std::vector<part::Vec3> piece;  // corners of the convex polygon that is not proven
};

struct CoveringProof {
  bool proven = false;
  bool given_up = false;     // there may be more holes than these
  std::vector<Hole> holes;   // empty when proven; else they contain all surface not proven
  std::uint64_t pieces = 0;  // that the proof looked at
};

// The proof is carried out at a radius that is smaller by this, m. It exceeds the rounding of
// vertices to meters, of the center's subtraction, of cuts and of distances.
double proof_margin(const part::Part& part, double radius);

// Proves that every point of `part` is within `radius` (m) of one of `points`, both relative to the
// same center. Gives up, not proven, once more than `max_holes` are known, and for a radius that
// rounding alone exceeds. The same result for any number of threads.
CoveringProof prove_covering(const part::Part& part, std::span<const part::Vec3> points,
                             double radius, std::size_t max_holes = SIZE_MAX);

// Continues a failed proof of the same part and radius with more points: looks only at the pieces
// with holes. With `hidden`, surface that it proves to lie inside another body need not be covered.
CoveringProof continue_proof(const part::Part& part, std::span<const part::Vec3> points,
                             double radius, const CoveringProof& failed,
                             const HiddenSurface* hidden = nullptr);

}  // namespace forcelayer::certificate

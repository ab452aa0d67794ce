// The proof that every surface point of a part lies within a radius of some shell point.
//
// Every triangle is bisected until each piece has its three corners within the radius of one common
// shell point. A ball is convex, so it then holds the whole piece. No sampling is involved, and
// rounding is accounted for: the proof is carried out at a radius that is smaller by more than all
// errors of the arithmetic together (proof_margin).
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pointshell/part.h"
#include "pointshell/vec3.h"

namespace forcelayer {

// A place on the surface where the proof failed.
struct Hole {
  Vec3 position;
  double distance = 0;  // m, to the nearest point; where none is close, a bound below it
};

struct CoveringProof {
  bool proven = false;
  std::vector<Hole> holes;   // empty when proven; at most one for every piece that failed
  std::uint64_t pieces = 0;  // that the proof looked at
};

// By how much the proof's radius is smaller than the radius it proves, m: more than the rounding of
// vertices to metres, of the centre's subtraction, of midpoints and of distances.
double proof_margin(const Part& part, double radius);

// Proves that every point of `part` is within `radius` (m) of one of `points`, both relative to the
// same centre. The same result for any number of threads.
CoveringProof prove_covering(const Part& part, std::span<const Vec3> points, double radius);

}  // namespace forcelayer

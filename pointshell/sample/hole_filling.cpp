#include "pointshell/sample/hole_filling.h"

#include <algorithm>

#include "pointshell/sample/sparse_set.h"
#include "pointshell/sample/stored_position.h"

namespace forcelayer::sample {
namespace {

// In radii. Loss at aimed_distance() above which a place gets a point; on a plane without edges the
// largest is 0.29.
constexpr double kFilledLoss = 0.485;
constexpr double kAddedSeparation = 2;  // of points that are added at once

}  // namespace

std::vector<part::Vec3> deepest_holes(std::vector<certificate::Hole> holes, double separation) {
  std::sort(holes.begin(), holes.end(), [](const certificate::Hole& a, const certificate::Hole& b) {
    if (a.distance != b.distance) return a.distance > b.distance;
    return part::lexicographic_less(a.position, b.position);
  });
  SparseSet chosen(separation);
  std::vector<part::Vec3> positions;
  for (const certificate::Hole& hole : holes) {
    const part::Vec3 position = as_stored(hole.position);
    if (chosen.any_within_separation(position)) continue;
    chosen.add(position);
    positions.push_back(position);
  }
  return positions;
}

std::size_t fill_lossy_places(certificate::CoveredPart covered, std::vector<part::Vec3>& points,
                              const part::Progress& progress) {
  const double limit = kFilledLoss * covered.radius;
  const std::size_t before = points.size();
  covered.points = points;
  std::vector<certificate::Hole> holes = certificate::places_above_loss(covered, limit, progress);
  while (!holes.empty()) {
    const std::vector<part::Vec3> added = deepest_holes(holes, kAddedSeparation * covered.radius);
    points.insert(points.end(), added.begin(), added.end());
    covered.points = points;
    holes = certificate::places_above_loss(covered, limit, holes);
  }
  return points.size() - before;
}

certificate::CoveringProof fill_holes(const part::Part& part, double radius,
                                      std::vector<part::Vec3>& points) {
  certificate::CoveringProof proof = certificate::prove_covering(part, points, radius);
  while (!proof.proven) {
    const std::vector<part::Vec3> added = deepest_holes(proof.holes, radius);
    points.insert(points.end(), added.begin(), added.end());
    proof = certificate::continue_proof(part, points, radius, proof);
  }
  return proof;
}

}  // namespace forcelayer::sample

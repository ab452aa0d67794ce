#include "pointshell/sample/hole_filling.h"

#include <tbb/parallel_sort.h>

#include <utility>

#include "pointshell/sample/sparse_set.h"
#include "pointshell/sample/stored_position.h"

namespace forcelayer::sample {
namespace {

// In radii. Loss at aimed_distance() above which a place gets a point; on a plane without edges the
// largest is 0.29.
constexpr double kFilledLoss = 0.485;
constexpr double kAddedSeparation = 2;  // of points that are added at once

}  // namespace

std::vector<part::Vec3> deepest_holes(std::span<const certificate::Hole> holes, double separation) {
  std::vector<std::pair<double, part::Vec3>> by_depth;
  by_depth.reserve(holes.size());
  for (const certificate::Hole& hole : holes) by_depth.push_back({hole.distance, hole.position});
  tbb::parallel_sort(by_depth.begin(), by_depth.end(), [](const auto& a, const auto& b) {
    if (a.first != b.first) return a.first > b.first;
    return part::lexicographic_less(a.second, b.second);
  });
  SparseSet chosen(separation);
  std::vector<part::Vec3> positions;
  for (const auto& [depth, place] : by_depth) {
    const part::Vec3 position = as_stored(place);
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

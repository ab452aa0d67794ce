#include "pointshell/sample/hole_filling.h"

#include <algorithm>
#include <cstdint>
#include <unordered_map>

#include "pointshell/sample/stored_position.h"

namespace forcelayer::sample {
namespace {

// A growing set of points in cubic cells, to ask whether any is close.
class SparseSet {
 public:
  explicit SparseSet(double separation) : separation_(separation) {}

  bool any_within_separation(const part::Vec3& p) const {
    for (int di = -1; di <= 1; ++di) {
      for (int dj = -1; dj <= 1; ++dj) {
        for (int dk = -1; dk <= 1; ++dk) {
          const auto found = cells_.find(key_of(p, di, dj, dk));
          if (found == cells_.end()) continue;
          for (const part::Vec3& q : found->second) {
            if (part::length_squared(p - q) < separation_ * separation_) return true;
          }
        }
      }
    }
    return false;
  }

  void add(const part::Vec3& p) { cells_[key_of(p, 0, 0, 0)].push_back(p); }

 private:
  // Far cells may share a key, which costs time and changes nothing.
  std::uint64_t key_of(const part::Vec3& p, int di, int dj, int dk) const {
    const auto bits = [&](double coordinate, int step) {
      const double cell = std::floor(coordinate / separation_) + step;
      return static_cast<std::uint64_t>(static_cast<std::int64_t>(cell)) & ((1u << 21) - 1);
    };
    return bits(p.x, di) << 42 | bits(p.y, dj) << 21 | bits(p.z, dk);
  }

  double separation_;
  std::unordered_map<std::uint64_t, std::vector<part::Vec3>> cells_;
};

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

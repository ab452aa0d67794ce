// A growing set of points in cubic cells, to ask whether any is close.
#pragma once

#include <unordered_map>
#include <vector>

#include "pointshell/part/vec3.h"

namespace forcelayer::sample {

class SparseSet {
 public:
  explicit SparseSet(double separation)
      : separation_(separation), cell_edge_(2 * separation * kRoundedUp) {}

  bool any_within_separation(const part::Vec3& p) const {
    const double half = cell_edge_ / 2;
    const auto [i, j, k] = part::cube_at(p - part::Vec3{half, half, half}, cell_edge_);
    for (const std::int64_t x : {i, i + 1}) {
      for (const std::int64_t y : {j, j + 1}) {
        for (const std::int64_t z : {k, k + 1}) {
          const auto found = cells_.find({x, y, z});
          if (found == cells_.end()) continue;
          for (const part::Vec3& q : found->second) {
            if (part::length_squared(p - q) < separation_ * separation_) return true;
          }
        }
      }
    }
    return false;
  }

  void add(const part::Vec3& p) { cells_[part::cube_at(p, cell_edge_)].push_back(p); }

 private:
  static constexpr double kRoundedUp = 1 + 1e-9;  // so that no cell is missed by rounding

  double separation_, cell_edge_;
  std::unordered_map<part::Cube, std::vector<part::Vec3>, part::CubeHash> cells_;
};

}  // namespace forcelayer::sample

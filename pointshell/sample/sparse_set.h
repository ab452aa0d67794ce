// A growing set of points in cubic cells, to ask whether any is close.
#pragma once

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "pointshell/part/vec3.h"

namespace forcelayer::sample {

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

}  // namespace forcelayer::sample

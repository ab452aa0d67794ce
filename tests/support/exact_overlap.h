// Whether a triangle has a point in a half-open box, by Fourier-Motzkin elimination: slow, exact,
// and unlike the separating axes that it judges.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "formats/lattice/voxel_overlap.h"

namespace forcelayer::reference {

// a s + b t >= c, or > c where `strict`.
template <class Int>
struct Constraint {
  Int a, b, c;
  bool strict;
};

// Whether some s satisfies every `a s >= c` (b is not looked at).
template <class Int>
bool feasible_in_s(const std::vector<Constraint<Int>>& constraints) {
  for (const auto& p : constraints) {
    if (p.a == 0 && (p.strict ? p.c >= 0 : p.c > 0)) return false;
  }
  for (const auto& lower : constraints) {
    if (lower.a <= 0) continue;
    for (const auto& upper : constraints) {
      if (upper.a >= 0) continue;
      // s >= lower.c / lower.a and s <= upper.c / upper.a.
      const Int gap =
          upper.c * lower.a * -1 + lower.c * upper.a;  // (upper - lower), denominators > 0
      if (lower.strict || upper.strict ? gap <= 0 : gap < 0) return false;
    }
  }
  return true;
}

// Whether the closed triangle has a point p with low <= p < high in every coordinate, or low < p <=
// high where `high_closed`. `Int` must hold products of four extents.
template <class Int>
bool overlaps(const lattice::LatticeTriangle& triangle, const lattice::LatticePoint& low,
              const lattice::LatticePoint& high, const std::array<bool, 3>& high_closed = {}) {
  // p = v0 + s (v1 - v0) + t (v2 - v0) with s, t >= 0 and s + t <= 1.
  std::vector<Constraint<Int>> all = {{1, 0, 0, false}, {0, 1, 0, false}, {-1, -1, -1, false}};
  for (std::size_t d = 0; d < 3; ++d) {
    const Int a = Int(triangle[1][d]) - triangle[0][d];
    const Int b = Int(triangle[2][d]) - triangle[0][d];
    all.push_back({a, b, Int(low[d]) - triangle[0][d], high_closed[d]});
    all.push_back({-a, -b, Int(triangle[0][d]) - high[d], !high_closed[d]});
  }
  std::vector<Constraint<Int>> in_s;  // with t eliminated
  for (const auto& p : all) {
    if (p.b == 0) in_s.push_back(p);
    if (p.b <= 0) continue;
    for (const auto& q : all) {
      if (q.b >= 0) continue;
      in_s.push_back({p.b * q.a - q.b * p.a, 0, p.b * q.c - q.b * p.c, p.strict || q.strict});
    }
  }
  return feasible_in_s(in_s);
}

// The same for voxel (i, j, k) in cells of `edge` voxels whose lowest corner it is.
template <class Int>
bool overlaps_cell(const lattice::LatticeTriangle& triangle, const lattice::VoxelIndex& voxel,
                   std::int64_t edge = 1) {
  lattice::LatticePoint low, high;
  for (std::size_t d = 0; d < 3; ++d) {
    low[d] = voxel[d] * lattice::kSnapUnits;
    high[d] = low[d] + edge * lattice::kSnapUnits;
  }
  return overlaps<Int>(triangle, low, high);
}

}  // namespace forcelayer::reference

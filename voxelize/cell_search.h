// From the triangles near a 64^3 node to those that matter to each of its cells of 4^3 voxels.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>
#include <vector>

#include "voxelize/triangle_distance.h"

namespace forcelayer {

// Of a cell what matters: triangles within `reach_voxels` of one of its voxels' centres, or none.
inline constexpr float kNothingMatters = -1;

// Halves of the diagonal of the box of a cube's voxel centres.
inline float half_diagonal(int edge_voxels) {
  return 0.8660255f * static_cast<float>(edge_voxels - 1);
}

// Two levels of 4^3 cells. Lists are sets: whatever they leave out cannot matter, and what is found
// does not depend on what they hold beside.
class CellSearch {
 public:
  using List = std::vector<NearCandidate>;

  // Calls leaf(low, triangles) for the cells that something matters to: `low` is the cell's lowest
  // voxel, from the node's. reach_of(low, edge) is asked for cells of 16 and of 4 voxels. With
  // `nearest_only` a triangle matters only where it may be the nearest to some voxel's centre.
  template <class ReachOf, class Leaf>
  void run(const std::vector<NearTriangle>& near, bool nearest_only, const ReachOf& reach_of,
           const Leaf& leaf) {
    all_.clear();
    for (const NearTriangle& triangle : near) all_.push_back({&triangle, 0});
    split(all_, {0, 0, 0}, 16, nearest_only, reach_of, cells_[0]);
    for (std::size_t n = 0; n < kCubePoints; ++n) {
      if (cells_[0][n].empty()) continue;
      const std::array<int, 3> low = child({0, 0, 0}, n, 16);
      split(cells_[0][n], low, 4, nearest_only, reach_of, cells_[1]);
      for (std::size_t m = 0; m < kCubePoints; ++m) {
        if (!cells_[1][m].empty()) leaf(child(low, m, 4), std::span(cells_[1][m]));
      }
    }
  }

  // The centres of the 4^3 voxels, or of the cells of `edge` voxels, from voxel `low` on.
  static PointCube centers(const std::array<int, 3>& low, int edge) {
    constexpr auto kUnits = static_cast<float>(kSnapUnits);
    PointCube points{};
    points.step = static_cast<float>(edge) * kUnits;
    for (std::size_t d = 0; d < 3; ++d) {
      points.first[d] = static_cast<float>(low[d]) * kUnits + points.step / 2;
    }
    return points;
  }

 private:
  static std::array<int, 3> child(const std::array<int, 3>& low, std::size_t n, int edge) {
    const int i = static_cast<int>(n);
    return {low[0] + edge * (i >> 4), low[1] + edge * (i >> 2 & 3), low[2] + edge * (i & 3)};
  }

  template <class ReachOf>
  void split(const List& triangles, const std::array<int, 3>& low, int edge, bool nearest_only,
             const ReachOf& reach_of, std::array<List, kCubePoints>& cells) {
    constexpr auto kUnits = static_cast<float>(kSnapUnits);
    for (List& cell : cells) cell.clear();
    if (triangles.empty()) return;
    if (squared_.size() < triangles.size()) squared_.resize(triangles.size());
    CubeValues least;
    squared_distances(triangles, centers(low, edge), squared_.data(), least);
    CubeValues limits;
    bool any = false;
    for (std::size_t n = 0; n < kCubePoints; ++n) {
      const float reach = reach_of(child(low, n, edge), edge);
      float limit = (reach + half_diagonal(edge) + kDistanceErrorVoxels) * kUnits;
      if (nearest_only) {
        limit = std::min(
            limit, std::sqrt(least[n]) + 2 * (half_diagonal(edge) + kDistanceErrorVoxels) * kUnits);
      }
      // A cell none of whose voxels is in reach needs no triangle at all.
      limits[n] = reach < 0 ? -1.0f : limit * limit;
      any |= reach >= 0;
    }
    if (!any) return;
    const float around = (half_diagonal(edge) + kDistanceErrorVoxels) * kUnits;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      std::uint64_t within = bits_within(squared_[i], limits);
      for (; within != 0; within &= within - 1) {
        const auto n = static_cast<std::size_t>(std::countr_zero(within));
        const float beyond = std::max(std::sqrt(squared_[i][n]) - around, 0.0f);
        List& cell = cells[n];
        cell.push_back({triangles[i].triangle, beyond * beyond});
        // The nearest to the middle comes first.
        if (squared_[i][n] == least[n]) std::swap(cell.front(), cell.back());
      }
    }
  }

  List all_;
  std::array<std::array<List, kCubePoints>, 2> cells_;
  std::vector<CubeValues> squared_;
};

}  // namespace forcelayer

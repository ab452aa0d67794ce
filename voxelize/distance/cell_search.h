// From the triangles near a 64^3 node to those that matter to each of its cells of 4^3 voxels.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <memory>
#include <vector>

#include "formats/mesh/voxel_overlap.h"
#include "voxelize/distance/triangle_distance.h"

namespace forcelayer {

// Of a cell what matters: triangles within `reach_voxels` of one of its voxels' centres, or none.
inline constexpr float kNothingMatters = -1;

// Two levels of 4^3 cells. Lists are sets: whatever they leave out cannot matter, and what is found
// does not depend on what they hold beside.
class CellSearch {
 public:
  // Calls leaf(low, triangles) for the cells that something matters to: `low` is the cell's lowest
  // voxel, from the node's. reach_of(low, edge) is asked for cells of 16 and of 4 voxels. A
  // triangle matters only where it may be the nearest to some voxel's centre. Cells come in pairs,
  // the second behind the first along z.
  template <class ReachOf, class Leaf>
  void run(const std::vector<NearTriangle>& near, const ReachOf& reach_of, const Leaf& leaf) {
    split_node(near, reach_of);
    for (std::size_t n = 0; n < kCubePoints; ++n) {
      if (cells_[0][n].empty()) continue;
      const std::array<int, 3> low = child({0, 0, 0}, n, 16);
      split_cell(cells_[0][n], low, reach_of);
      for (std::size_t m = 0; m < kCubePoints; ++m) {
        if (!cells_[1][m].empty()) leaf(child(low, m, 4), NearList(cells_[1][m]));
      }
    }
  }

  // The centres of the 4^3 voxels, or of the cells of `edge` voxels, from voxel `low` on.
  static PointCube centers(const std::array<int, 3>& low, int edge) {
    PointCube points{};
    points.step = static_cast<float>(edge) * kUnits;
    for (std::size_t d = 0; d < 3; ++d) {
      points.first[d] = static_cast<float>(low[d]) * kUnits + points.step / 2;
    }
    return points;
  }

 private:
  using List = std::vector<const NearTriangle*>;

  static constexpr auto kUnits = static_cast<float>(kSnapUnits);

  static std::array<int, 3> child(const std::array<int, 3>& low, std::size_t n, int edge) {
    const int i = static_cast<int>(n);
    return {low[0] + edge * (i >> 4), low[1] + edge * (i >> 2 & 3), low[2] + edge * (i & 3)};
  }

  // From the middle of a cell to what may matter to one of its voxels' centres, lattice units.
  static float limit_of(float reach_voxels, int edge) {
    return (reach_voxels + half_diagonal(edge) + kDistanceErrorVoxels) * kUnits;
  }

  // Bits of the node's cells of 16 voxels that have a centre within `reach_voxels` of the
  // triangle's bounding box.
  static std::uint64_t cells_beside(const NearTriangle& t, float reach_voxels) {
    constexpr std::uint64_t kFirst[3] = {0xffff, 0x000f000f000f000f, 0x1111111111111111};
    const float around = (reach_voxels + kDistanceErrorVoxels) * kUnits;
    std::uint64_t cells = ~std::uint64_t{0};
    for (std::size_t d = 0; d < 3; ++d) {
      const float least = t.corner[d] + std::min({0.0f, t.edge_1[d], t.edge_2[d]}) - around;
      const float most = t.corner[d] + std::max({0.0f, t.edge_1[d], t.edge_2[d]}) + around;
      std::uint64_t beside = 0;
      for (int i = 0; i < 4; ++i) {
        // A cell's first centre and its last.
        const float first = (16 * static_cast<float>(i) + 0.5f) * kUnits,
                    last = first + 15 * kUnits;
        if (least <= last && most >= first) beside |= kFirst[d] << ((16 >> (2 * d)) * i);
      }
      cells &= beside;
    }
    return cells;
  }

  // What matters to the node's cells of 16 voxels: by the triangles' bounding boxes, and of those
  // that are large by their distances too.
  template <class ReachOf>
  void split_node(const std::vector<NearTriangle>& near, const ReachOf& reach_of) {
    constexpr int kManyCells = 8;
    for (List& cell : cells_[0]) cell.clear();
    CubeValues limits;
    std::uint64_t open = 0;
    float most = 0;
    for (std::size_t n = 0; n < kCubePoints; ++n) {
      const float reach = reach_of(child({0, 0, 0}, n, 16), 16);
      limits[n] = limit_of(reach, 16) * limit_of(reach, 16);
      if (reach >= 0) open |= std::uint64_t{1} << n;
      most = std::max(most, reach);
    }
    large_.clear();
    for (const NearTriangle& triangle : near) {
      const std::uint64_t cells = open & cells_beside(triangle, most);
      if (std::popcount(cells) > kManyCells) {
        large_.push_back(&triangle);
      } else {
        add(&triangle, cells, cells_[0]);
      }
    }
    CubeValues least;
    measure(large_, {0, 0, 0}, 16, least);
    bits_within(squared_.get(), large_.size(), limits, within_.get());
    for (std::size_t i = 0; i < large_.size(); ++i) {
      add(large_[i], within_[i] & open & cells_beside(*large_[i], most), cells_[0]);
    }
  }

  // What of a cell of 16 voxels matters to its cells of 4.
  template <class ReachOf>
  void split_cell(const List& triangles, const std::array<int, 3>& low, const ReachOf& reach_of) {
    for (List& cell : cells_[1]) cell.clear();
    CubeValues least;
    measure(triangles, low, 4, least);
    CubeValues limits;
    for (std::size_t n = 0; n < kCubePoints; ++n) {
      const float reach = reach_of(child(low, n, 4), 4);
      const float limit = std::min(limit_of(reach, 4), std::sqrt(least[n]) + 2 * limit_of(0, 4));
      // A cell none of whose voxels is in reach needs no triangle at all.
      limits[n] = reach < 0 ? -1.0f : limit * limit;
    }
    bits_within(squared_.get(), triangles.size(), limits, within_.get());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const std::uint64_t pairs = (within_[i] | within_[i] >> 1) & 0x5555555555555555u;
      add(triangles[i], pairs, cells_[1]);
    }
  }

  // Squared distances from the middles of cells, to squared_, and the least of each.
  void measure(const List& triangles, const std::array<int, 3>& low, int edge, CubeValues& least) {
    if (room_ < triangles.size()) {
      const std::size_t room = triangles.size() + triangles.size() / 2;
      room_ = 0;
      squared_.reset();
      squared_ = std::make_unique_for_overwrite<CubeValues[]>(room);
      within_ = std::make_unique_for_overwrite<std::uint64_t[]>(room);
      room_ = room;
    }
    squared_distances(triangles, centers(low, edge), squared_.get(), least);
  }

  static void add(const NearTriangle* triangle, std::uint64_t cells,
                  std::array<List, kCubePoints>& lists) {
    for (; cells != 0; cells &= cells - 1) {
      lists[static_cast<std::size_t>(std::countr_zero(cells))].push_back(triangle);
    }
  }

  std::array<std::array<List, kCubePoints>, 2> cells_;
  List large_;
  // Of a list that is measured, [triangles], with room for room_. Not vectors: those would write
  // all of it before, and copy it to grow, and to touch memory for the first time takes longest.
  std::size_t room_ = 0;
  std::unique_ptr<CubeValues[]> squared_;
  std::unique_ptr<std::uint64_t[]> within_;  // bits of cells
};

}  // namespace forcelayer

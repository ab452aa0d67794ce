// The search for the triangles that can be the nearest to a voxel: from the whole scene to 64^3
// nodes (SceneTriangles), from a node to its cells of 16^3, 8^3 and 4^3 voxels (CellSearch).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "voxelize/distance/distance_kernel.h"
#include "voxelize/scan/node_bins.h"

namespace forcelayer::distance {

// Cutting a triangle puts corners of its pieces on edges: three in a row, or two or three at one
// place. The normal of such a piece is that of its rounding, so it becomes its longest edge.
void flatten_if_thin(std::array<std::array<double, 3>, 3>& piece);

// The triangles of some objects, sorted by the nodes that they come near to.
class SceneTriangles {
 public:
  // A triangle is near a node when it comes nearer than `reach` voxels (1..64). The objects must
  // outlive this, and so must the file that the lists wait in, if there is one. The triangles'
  // sides are found on request: without that, all are open.
  SceneTriangles(std::vector<const scan::SnappedObject*> objects, int reach,
                 scan::SpillFile* spill = nullptr, bool finds_sides = false);

  // The nodes that have triangles near, ascending.
  const std::vector<scan::NodeIndex>& nodes() const { return nodes_; }

  // The objects that have triangles near `node`, ascending.
  std::vector<std::uint32_t> objects_near(const scan::NodeIndex& node) const;

  // The triangles near `node`, in lattice units from its lowest corner and in the order of their
  // objects; empty for a node that is not in nodes(). A large triangle is cut to the piece that
  // lies near, so that single precision can hold it.
  void gather(const scan::NodeIndex& node, std::vector<PreparedTriangle>& near) const;

  // The whole triangle that `near`, from gather(), is or is a piece of, in lattice units.
  lattice::LatticeTriangle original(const PreparedTriangle& near) const {
    return objects_[near.object]->triangle(near.source);
  }
  // The side of a whole triangle as it is wound.
  TriangleSide side_of(std::uint32_t object, std::uint32_t triangle) const {
    return sides_.empty() ? TriangleSide() : sides_[object][triangle];
  }

 private:
  struct Bin {
    std::uint32_t object, bin;
  };

  // How many triangles are near nodes_[n].
  std::size_t count_near(std::size_t n) const;

  std::vector<const scan::SnappedObject*> objects_;
  int reach_;
  scan::SpillFile* spill_;
  std::vector<scan::NodeBins> bins_;    // [objects]
  std::vector<SurfaceSides> sides_;     // [objects], or empty
  std::vector<scan::NodeIndex> nodes_;  // [n]
  std::vector<std::size_t> first_;      // [n + 1] offsets into of_node_
  std::vector<Bin> of_node_;
  std::size_t max_near_ = 0;  // the most that count_near() gives
};

// The reach of a cell that needs no triangle.
inline constexpr float kNoReach = -1;

// The search inside one node: from the node to cells of 16, 8 and 4 voxels. Its lists are
// supersets: a triangle that is left out cannot be the nearest to a voxel within the cell's reach,
// nor as near as the nearest of its object, and the result does not depend on the others.
class CellSearch {
 public:
  // Calls leaf(low, triangles, around) for cells of 4^3 voxels. `low` is the cell's lowest voxel,
  // counted from the node's. `triangles` may be the nearest to the center of one of the cell's
  // voxels, within the reach. `around` are all triangles whose boxes are within the reach of the
  // center of a voxel of the cell of 16^3 voxels that holds this one. reach_of(low, edge) gives the
  // reach, in voxels, of the cell of `edge` voxels (16, 8 or 4) at `low`, or kNoReach.
  template <class ReachOf, class Leaf>
  void run(const std::vector<PreparedTriangle>& near, const ReachOf& reach_of, const Leaf& leaf) {
    split_node(near, reach_of);
    for (std::size_t n = 0; n < kCubePoints; ++n) {
      if (cells_[n].empty()) continue;
      const std::array<int, 3> low = child({0, 0, 0}, n, 16);
      const TriangleList around(cells_[n]);
      split_cell(around, low, 8, reach_of, eighths_[0]);
      for (unsigned i = 0; i < kEighths; ++i) {
        if (eighths_[0][i].empty()) continue;
        const std::array<int, 3> of_8 = eighth_of(low, i, 8);
        split_cell(eighths_[0][i], of_8, 4, reach_of, eighths_[1]);
        for (unsigned j = 0; j < kEighths; ++j) {
          if (eighths_[1][j].empty()) continue;
          leaf(eighth_of(of_8, j, 4), TriangleList(eighths_[1][j]), around);
        }
      }
    }
  }

  // The centers of 4^3 voxels (edge = 1) or of 4^3 cells of `edge` voxels, from voxel `low` on.
  static PointCube centers(const std::array<int, 3>& low, int edge) {
    PointCube points{};
    points.step = static_cast<float>(edge) * kUnits;
    for (std::size_t d = 0; d < 3; ++d) {
      points.first[d] = static_cast<float>(low[d]) * kUnits + points.step / 2;
    }
    return points;
  }

 private:
  using List = std::vector<const PreparedTriangle*>;

  static constexpr auto kUnits = static_cast<float>(lattice::kSnapUnits);

  static std::array<int, 3> child(const std::array<int, 3>& low, std::size_t n, int edge) {
    const int i = static_cast<int>(n);
    return {low[0] + edge * (i >> 4), low[1] + edge * (i >> 2 & 3), low[2] + edge * (i & 3)};
  }
  static std::array<int, 3> eighth_of(const std::array<int, 3>& low, unsigned n, int edge) {
    const int i = static_cast<int>(n);
    return {low[0] + edge * (i >> 2), low[1] + edge * (i >> 1 & 1), low[2] + edge * (i & 1)};
  }

  // The largest distance of a triangle from a cell's middle at which it can be within reach of one
  // of the cell's voxel centers, lattice units.
  static float limit_of(float reach_voxels, int edge) {
    return (reach_voxels + half_diagonal(edge) + kKernelErrorVoxels) * kUnits;
  }

  // The node's cells of 16 voxels that have a voxel center within `reach_voxels` of the triangle's
  // bounding box, as bits.
  static std::uint64_t cells_beside(const PreparedTriangle& t, float reach_voxels) {
    constexpr std::uint64_t kFirst[3] = {0xffff, 0x000f000f000f000f, 0x1111111111111111};
    const float around = (reach_voxels + kKernelErrorVoxels) * kUnits;
    std::uint64_t cells = ~std::uint64_t{0};
    for (std::size_t d = 0; d < 3; ++d) {
      const float smallest = t.corner[d] + std::min({0.0f, t.edge_1[d], t.edge_2[d]}) - around;
      const float largest = t.corner[d] + std::max({0.0f, t.edge_1[d], t.edge_2[d]}) + around;
      std::uint64_t beside = 0;
      for (int i = 0; i < 4; ++i) {
        // The cell's first voxel center and its last.
        const float first = (16 * static_cast<float>(i) + 0.5f) * kUnits,
                    last = first + 15 * kUnits;
        if (smallest <= last && largest >= first) beside |= kFirst[d] << ((16 >> (2 * d)) * i);
      }
      cells &= beside;
    }
    return cells;
  }

  // Lists the triangles of the node's cells of 16 voxels by their bounding boxes. A triangle whose
  // box touches many cells is listed by its distance from each too.
  template <class ReachOf>
  void split_node(const std::vector<PreparedTriangle>& near, const ReachOf& reach_of) {
    constexpr int kManyCells = 8;
    for (List& cell : cells_) cell.clear();
    CubeValues limits;
    std::uint64_t open = 0;
    float largest = 0;
    for (std::size_t n = 0; n < kCubePoints; ++n) {
      const float reach = reach_of(child({0, 0, 0}, n, 16), 16);
      limits[n] = limit_of(reach, 16) * limit_of(reach, 16);
      if (reach >= 0) open |= std::uint64_t{1} << n;
      largest = std::max(largest, reach);
    }
    large_.clear();
    for (const PreparedTriangle& triangle : near) {
      const std::uint64_t cells = open & cells_beside(triangle, largest);
      if (std::popcount(cells) > kManyCells) {
        large_.push_back(&triangle);
      } else {
        add(&triangle, cells, cells_);
      }
    }
    CubeValues smallest;
    measure(large_, {0, 0, 0}, 16, smallest);
    bits_within(squared_.get(), large_.size(), limits, within_.get());
    for (std::size_t i = 0; i < large_.size(); ++i) {
      add(large_[i], within_[i] & open & cells_beside(*large_[i], largest), cells_);
    }
  }

  // Lists the triangles of each eighth of a cell. An eighth has an edge of `edge` voxels.
  template <class ReachOf>
  void split_cell(TriangleList triangles, const std::array<int, 3>& low, int edge,
                  const ReachOf& reach_of, std::array<List, kEighths>& lists) {
    std::array<float, kEighths> reach;
    for (unsigned n = 0; n < kEighths; ++n) {
      lists[n].clear();
      reach[n] = reach_of(eighth_of(low, n, edge), edge) * kUnits;
    }
    near_.find(triangles, low, edge, reach);
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      for (unsigned bits = near_.eighths(i); bits != 0; bits &= bits - 1) {
        lists[static_cast<std::size_t>(std::countr_zero(bits))].push_back(triangles[i]);
      }
    }
  }

  // Writes the squared distances of the cells' middles from each triangle into squared_, and each
  // cell's least one into `smallest`.
  void measure(const List& triangles, const std::array<int, 3>& low, int edge,
               CubeValues& smallest) {
    if (room_ < triangles.size()) {
      const std::size_t room = triangles.size() + triangles.size() / 2;
      room_ = 0;
      squared_.reset();
      squared_ = std::make_unique_for_overwrite<CubeValues[]>(room);
      within_ = std::make_unique_for_overwrite<std::uint64_t[]>(room);
      room_ = room;
    }
    squared_distances(triangles, centers(low, edge), squared_.get(), smallest);
  }

  static void add(const PreparedTriangle* triangle, std::uint64_t cells,
                  std::array<List, kCubePoints>& lists) {
    for (; cells != 0; cells &= cells - 1) {
      lists[static_cast<std::size_t>(std::countr_zero(cells))].push_back(triangle);
    }
  }

  std::array<List, kCubePoints> cells_;                // of 16 voxels
  std::array<std::array<List, kEighths>, 2> eighths_;  // of 8 and of 4 voxels, of one cell each
  NearEighths near_;
  List large_;
  // Results of measure(), [triangles], with room for room_ triangles. Not vectors: a vector would
  // zero its elements and copy them to grow, and the first touch of memory is the slowest.
  std::size_t room_ = 0;
  std::unique_ptr<CubeValues[]> squared_;
  std::unique_ptr<std::uint64_t[]> within_;  // the cells within the limit, as bits
};

}  // namespace forcelayer::distance

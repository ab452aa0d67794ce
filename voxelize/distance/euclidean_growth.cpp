#include "voxelize/distance/euclidean_growth.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>

#include "formats/lattice/brick_bits.h"
#include "voxelize/distance/triangle_search.h"
#include "voxelize/masks/node_rows.h"

namespace forcelayer::distance {
namespace {

__extension__ typedef __int128 Int128;
using WideInt = boost::multiprecision::int512_t;  // for triangles of up to 2^31 voxels

constexpr auto kUnits = static_cast<float>(lattice::kSnapUnits);

// The exact test. The nearest point of a triangle is a corner, or lies on an edge or inside. Each
// distance is a quotient of integers, which is compared with the radius without dividing.
template <class Int>
class CenterTest {
 public:
  using Vec = std::array<Int, 3>;

  // Corners in lattice units from the voxel's center.
  CenterTest(const std::array<lattice::LatticePoint, 3>& corners, std::int64_t radius_units)
      : radius2_(Int(radius_units) * radius_units) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t d = 0; d < 3; ++d) corners_[k][d] = corners[k][d];
    }
  }

  bool near() const {
    for (std::size_t k = 0; k < 3; ++k) {
      if (dot(corners_[k], corners_[k]) < radius2_) return true;
      if (edge_is_near(corners_[k], corners_[(k + 1) % 3])) return true;
    }
    return inside_is_near();
  }

 private:
  static Vec minus(const Vec& a, const Vec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  static Int dot(const Vec& a, const Vec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
  static Vec cross(const Vec& a, const Vec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }

  bool edge_is_near(const Vec& from, const Vec& to) const {
    const Vec along = minus(to, from);
    const Int t = -dot(from, along), length2 = dot(along, along);
    if (t <= 0 || t >= length2) return false;
    const Vec n = cross(from, along);
    return dot(n, n) < radius2_ * length2;
  }

  bool inside_is_near() const {
    const Vec n = cross(minus(corners_[1], corners_[0]), minus(corners_[2], corners_[0]));
    const Int n2 = dot(n, n);
    if (n2 == 0) return false;
    Int h = dot(n, corners_[0]);
    if (h < 0) h = -h;
    // The test is h^2 < radius^2 n^2; h^2 would overflow where h is far too large.
    if constexpr (std::is_same_v<Int, Int128>) {
      if (h >= Int{1} << 62) return false;
    }
    if (h * h >= radius2_ * n2) return false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec along = minus(corners_[(k + 1) % 3], corners_[k]);
      if (dot(cross(n, along), corners_[k]) > 0) return false;
    }
    return true;
  }

  std::array<Vec, 3> corners_;
  Int radius2_;
};

// One 64^3 node at a time.
class NodeGrowth {
 public:
  std::unique_ptr<masks::LowerMaskNode> run(const SceneTriangles& triangles,
                                            const CenterGrowth& growth, const scan::NodeIndex& node,
                                            const masks::Coord& origin,
                                            const masks::MaskTree& interior) {
    masks::node_rows(interior, origin, settled_);
    grown_ = {};
    triangles.gather(node, triangles_);
    search_.run(
        triangles_,
        [&](const std::array<int, 3>& low, int edge) {
          return masks::all_set(settled_, low, edge) ? kNoReach : growth.reach();
        },
        [&](const std::array<int, 3>& low, TriangleList list, TriangleList) {
          mark_cell(low, list, growth, node);
        });
    return masks::node_of_rows(grown_, origin);
  }

 private:
  void mark_cell(const std::array<int, 3>& low, TriangleList list, const CenterGrowth& growth,
                 const scan::NodeIndex& node) {
    const std::uint64_t open = ~masks::cell_bits(settled_, low);
    std::array<float, kEighths> reach;
    for (unsigned n = 0; n < kEighths; ++n) {
      reach[n] = (open & eighth(n)) != 0 ? growth.reach() * kUnits : kNoReach;
    }
    nearest_.find(list, low, reach);
    masks::add_cell_bits(growth.near(nearest_.smallest(), open, list, node, low), low, grown_);
  }

  masks::NodeRows grown_, settled_;  // the result; the interior, which needs no answer
  std::vector<PreparedTriangle> triangles_;
  CellSearch search_;
  NearestTriangles nearest_;
};

}  // namespace

bool center_is_nearer(const lattice::LatticeTriangle& triangle, const lattice::VoxelIndex& voxel,
                      std::int64_t radius_units) {
  std::array<lattice::LatticePoint, 3> corners;
  std::int64_t largest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t d = 0; d < 3; ++d) {
      corners[k][d] = triangle[k][d] - (voxel[d] << lattice::kSnapBits) - lattice::kSnapUnits / 2;
      largest = std::max(largest, std::abs(corners[k][d]));
    }
  }
  // Up to 2^20 units: edges up to 2^21, components of n up to 2^43, h below 2^65 (tested before it
  // is squared), radius^2 n^2 below 2^118, the sides of the inside test below 2^87.
  constexpr std::int64_t kLargest = std::int64_t{1} << 20;
  if (largest <= kLargest) return CenterTest<Int128>(corners, radius_units).near();
  return CenterTest<WideInt>(corners, radius_units).near();
}

CenterGrowth::CenterGrowth(const SceneTriangles& triangles, std::int64_t radius_units)
    : triangles_(triangles), radius_units_(radius_units) {
  const float radius = static_cast<float>(radius_units) / kUnits;
  reach_ = radius + kKernelErrorVoxels;
  const float surely = (radius - kKernelErrorVoxels) * kUnits, maybe = reach_ * kUnits;
  surely_near_.fill(surely * surely);
  maybe_near_.fill(maybe * maybe);
}

std::uint64_t CenterGrowth::near(const CubeValues& smallest, std::uint64_t open, TriangleList list,
                                 const scan::NodeIndex& node, const std::array<int, 3>& low) const {
  if (open == 0) return 0;
  std::uint64_t near = 0, maybe = 0;
  bits_within(&smallest, 1, maybe_near_, &maybe);
  if ((maybe & open) == 0) return 0;
  bits_within(&smallest, 1, surely_near_, &near);
  near &= open;
  for (std::uint64_t unsure = maybe & open & ~near; unsure != 0; unsure &= unsure - 1) {
    const int n = std::countr_zero(unsure);
    const lattice::VoxelIndex voxel{node[0] * 64 + low[0] + (n >> 4),
                                    node[1] * 64 + low[1] + (n >> 2 & 3),
                                    node[2] * 64 + low[2] + (n & 3)};
    if (is_near(list, voxel)) near |= std::uint64_t{1} << n;
  }
  return near;
}

bool CenterGrowth::is_near(TriangleList list, const lattice::VoxelIndex& voxel) const {
  return std::any_of(list.begin(), list.end(), [&](const PreparedTriangle* triangle) {
    return center_is_nearer(triangles_.original(*triangle), voxel, radius_units_);
  });
}

std::unique_ptr<masks::MaskTree> grow_surface(const scan::SnappedObject& object,
                                              const masks::MaskTree& interior,
                                              std::int64_t radius_units,
                                              const lattice::VoxelIndex& scene_origin) {
  const auto whole_voxels = static_cast<int>(radius_units / lattice::kSnapUnits);
  const SceneTriangles triangles({&object}, whole_voxels + 1);
  const CenterGrowth growth(triangles, radius_units);
  std::vector<std::unique_ptr<masks::LowerMaskNode>> nodes(triangles.nodes().size());
  tbb::enumerable_thread_specific<NodeGrowth> scratch;
  tbb::parallel_for(std::size_t{0}, nodes.size(), [&](std::size_t i) {
    const scan::NodeIndex& node = triangles.nodes()[i];
    const masks::Coord origin(static_cast<int>(node[0] * 64 - scene_origin[0]),
                              static_cast<int>(node[1] * 64 - scene_origin[1]),
                              static_cast<int>(node[2] * 64 - scene_origin[2]));
    nodes[i] = scratch.local().run(triangles, growth, node, origin, interior);
  });
  return masks::tree_of_nodes(nodes);
}

}  // namespace forcelayer::distance

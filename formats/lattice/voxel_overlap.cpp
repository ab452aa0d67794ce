#include "formats/lattice/voxel_overlap.h"

#include <algorithm>
#include <cmath>

namespace forcelayer::lattice {
namespace {

__extension__ typedef __int128 Int128;

// Up to this extent (512 voxels, in units) and cell, 64 bits hold every value of a test: the normal
// is below 2^38, a corner of a cell that touches the triangle's box below 2^20.
constexpr std::int64_t kNarrowExtent = std::int64_t{1} << 19;
constexpr int kNarrowLog2Cell = 6;
// Up to this extent, 64 bits hold 21 times the normal's largest component.
constexpr std::int64_t kWideExtent = std::int64_t{1} << 28;

// The two axes u, w of the projection along axis d, in the order of a mask's bits.
constexpr int kU[3] = {1, 0, 0};
constexpr int kW[3] = {2, 2, 1};

template <class Int>
Int floor_shift(Int value, int bits) {
  return value >> bits;
}
template <class Int>
Int ceil_shift(Int value, int bits) {
  return -((-value) >> bits);
}

// Bit i*8 + j where a i + b j >= t.
template <class Int>
std::uint64_t half_plane(Int a, Int b, Int t) {
  std::uint64_t mask = 0;
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      mask |= std::uint64_t{a * i + b * j >= t} << (i * 8 + j);
    }
  }
  return mask;
}

// Bit i*8 + j where lo <= a i + b j <= hi.
template <class Int>
std::uint64_t slab(Int a, Int b, Int lo, Int hi) {
  std::uint64_t mask = 0;
  for (int i = 0; i < 8; ++i) {
    for (int j = 0; j < 8; ++j) {
      const Int value = a * i + b * j;
      mask |= std::uint64_t{lo <= value && value <= hi} << (i * 8 + j);
    }
  }
  return mask;
}

// Bit i of the low eight fills byte i.
std::uint64_t fill_bytes(std::uint64_t bits) {
  constexpr std::uint64_t kLow = 0x0101010101010101u;
  constexpr std::uint64_t kDiagonal = 0x8040201008040201u;
  const std::uint64_t picked = (bits & 0xff) * kLow & kDiagonal;  // bit i at place i of byte i
  return ((picked + 0x7f7f7f7f7f7f7f7fu) >> 7 & kLow) * 0xff;     // any bit of a byte fills it
}

// The eight bits in every byte.
std::uint64_t repeat_byte(std::uint64_t bits) { return (bits & 0xff) * 0x0101010101010101u; }

// Bits first..last of eight, clipped; none where the range misses 0..7.
std::uint64_t range_bits(std::int64_t first, std::int64_t last) {
  if (last < 0 || first > 7) return 0;
  const auto from = static_cast<unsigned>(std::max<std::int64_t>(first, 0));
  const auto to = static_cast<unsigned>(std::min<std::int64_t>(last, 7));
  return (0xffu << from) & (0xffu >> (7 - to)) & 0xffu;
}

// `value` where the narrower type's comparisons below cannot tell the difference.
template <class To, class From>
To saturate(From value) {
  if constexpr (sizeof(From) <= sizeof(To)) {
    return value;
  } else {
    constexpr From kLimit = From{1} << (sizeof(To) * 8 - 2);
    return static_cast<To>(std::clamp(value, -kLimit, kLimit));
  }
}

template <class Int>
constexpr Int positive_part(Int value) {
  return value > 0 ? value : Int{0};
}

}  // namespace

LatticePoint snap(const std::array<double, 3>& position_m, double voxel_size_m) {
  LatticePoint point;
  for (int d = 0; d < 3; ++d) {
    point[d] = std::llrint(position_m[d] / voxel_size_m * static_cast<double>(kSnapUnits));
  }
  return point;
}

TriangleOverlap::TriangleOverlap(const LatticeTriangle& triangle) {
  for (int d = 0; d < 3; ++d) {
    const auto [smallest, greatest] = std::minmax({triangle[0][d], triangle[1][d], triangle[2][d]});
    low_[d] = smallest;
    min_voxel_[d] = smallest >> kSnapBits;
    max_voxel_[d] = greatest >> kSnapBits;
    extent_ = std::max(extent_, greatest - smallest);
    anchor_[d] = triangle[0][d] - smallest;
    side_1_[d] = triangle[1][d] - triangle[0][d];
    side_2_[d] = triangle[2][d] - triangle[0][d];
  }
  if (extent_ <= kWideExtent) {
    set_up_edges<std::int64_t>(triangle);
  } else {
    set_up_edges<Int128>(triangle);
  }
}

// Edge k runs from corner k to corner k + 1. Where the projection has an area, its sign turns the
// three edges so that the triangle lies on their positive side. Where it has none, the triangle's
// shadow is a segment: its longest edge bounds it from both sides, and the box at the ends.
template <class Int>
void TriangleOverlap::set_up_edges(const LatticeTriangle& corners) {
  for (int d = 0; d < 3; ++d) {
    const int u = kU[d], w = kW[d];
    const Int area = Int{side_1_[u]} * side_2_[w] - Int{side_1_[w]} * side_2_[u];
    const std::int64_t sign = area < 0 ? -1 : 1;
    std::array<Edge, 3>& edges = edges_[d];
    for (int k = 0; k < 3; ++k) {
      const LatticePoint& from = corners[k];
      const LatticePoint& to = corners[(k + 1) % 3];
      edges[k] = {-sign * (to[w] - from[w]), sign * (to[u] - from[u]), from[u] - low_[u],
                  from[w] - low_[w]};
    }
    if (area != 0) {
      degenerate_ = false;
      continue;
    }
    const auto length = [](const Edge& edge) {
      return std::max(std::abs(edge.a), std::abs(edge.b));
    };
    const Edge longest =
        *std::max_element(edges.begin(), edges.end(),
                          [&](const Edge& p, const Edge& q) { return length(p) < length(q); });
    edges = {longest, Edge{-longest.a, -longest.b, longest.u0, longest.w0}, Edge{}};
  }
}

BrickMask TriangleOverlap::cells(const VoxelIndex& corner, int log2_cell) const {
  if (extent_ <= kNarrowExtent && log2_cell <= kNarrowLog2Cell) {
    return tested_cells<std::int64_t, std::int64_t>(corner, log2_cell);
  }
  if (extent_ <= kWideExtent) return tested_cells<Int128, std::int64_t>(corner, log2_cell);
  return tested_cells<Int128, Int128>(corner, log2_cell);
}

// A cell's value along an axis n spans [v + qN, v + qP]: v = n . (lowest corner), q the cell's
// edge, N and P the sums of n's negative and positive parts; an end that lies on an open side is
// one step short. Lowest corners are start + q i, i in 0..7 per axis, so both bounds divide by q,
// exactly, and the 512 tests compare n . i alone.
template <class Base, class Lane>
BrickMask TriangleOverlap::tested_cells(const VoxelIndex& corner, int log2_cell) const {
  const int shift = kSnapBits + log2_cell;
  std::array<std::uint64_t, 3> range;
  std::array<Base, 3> start;  // lowest corner of the first cell, relative to low_
  for (int d = 0; d < 3; ++d) {
    range[d] = range_bits((min_voxel_[d] - corner[d]) >> log2_cell,
                          (max_voxel_[d] - corner[d]) >> log2_cell);
    if (range[d] == 0) return {};
    start[d] = Base{corner[d]} * kSnapUnits - low_[d];
  }

  std::array<std::uint64_t, 3> projected;
  for (int d = 0; d < 3; ++d) {
    projected[d] = ~std::uint64_t{0};
    for (const Edge& edge : edges_[d]) {
      const Base base =
          Base{edge.a} * (start[kU[d]] - edge.u0) + Base{edge.b} * (start[kW[d]] - edge.w0);
      const std::int64_t reach = positive_part(edge.a) + positive_part(edge.b);
      const Base smallest = ceil_shift<Base>((reach > 0 ? 1 : 0) - base, shift) - reach;
      projected[d] &= half_plane<std::int64_t>(edge.a, edge.b, saturate<std::int64_t>(smallest));
    }
  }

  const std::array<Lane, 3> normal = {
      Lane{side_1_[1]} * side_2_[2] - Lane{side_1_[2]} * side_2_[1],
      Lane{side_1_[2]} * side_2_[0] - Lane{side_1_[0]} * side_2_[2],
      Lane{side_1_[0]} * side_2_[1] - Lane{side_1_[1]} * side_2_[0]};
  Base base = 0;
  Lane up = 0, down = 0;
  for (int d = 0; d < 3; ++d) {
    base += Base{normal[d]} * (start[d] - anchor_[d]);
    up += positive_part(normal[d]);
    down -= positive_part(-normal[d]);
  }
  const Lane lo = saturate<Lane>(ceil_shift<Base>((up > 0 ? 1 : 0) - base, shift) - up);
  const Lane hi = saturate<Lane>(floor_shift<Base>(-(down < 0 ? 1 : 0) - base, shift) - down);

  BrickMask result;
  for (unsigned x = 0; x < 8; ++x) {
    if ((range[0] >> x & 1) == 0) continue;
    const std::uint64_t over_y = projected[2] >> (8 * x) & range[1];
    const std::uint64_t over_z = projected[1] >> (8 * x) & range[2];
    const std::uint64_t shadow = projected[0] & fill_bytes(over_y) & repeat_byte(over_z);
    if (shadow == 0) continue;
    const Lane offset = normal[0] * static_cast<std::int64_t>(x);
    result.words[x] = shadow & slab<Lane>(normal[1], normal[2], lo - offset, hi - offset);
  }
  return result;
}

std::vector<VoxelIndex> overlapped_voxels(const LatticeTriangle& triangle) {
  std::vector<VoxelIndex> voxels;
  for_each_group(TriangleOverlap(triangle), 0,
                 [&](const VoxelIndex& corner, const BrickMask& mask) {
                   for_each_cell(mask, [&](std::int64_t x, std::int64_t y, std::int64_t z) {
                     voxels.push_back({corner[0] + x, corner[1] + y, corner[2] + z});
                   });
                 });
  return voxels;
}

}  // namespace forcelayer::lattice

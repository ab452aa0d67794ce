#include "voxelize/large_triangle.h"

// Compiled once for every instruction set that Highway supports, picked at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/large_triangle.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include "voxelize/square_cells-inl.h"

#include <algorithm>
#include <array>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::HWY_NAMESPACE {
namespace {

constexpr std::size_t kU[3] = {1, 0, 0}, kW[3] = {2, 2, 1};  // axes of the projections

HWY_INLINE std::int64_t ceil_shift(std::int64_t value, int bits) { return -(-value >> bits); }
HWY_INLINE std::int64_t positive(std::int64_t value) { return std::max<std::int64_t>(value, 0); }
HWY_INLINE std::int64_t negative(std::int64_t value) { return std::min<std::int64_t>(value, 0); }

// Bits first..last of eight, clipped.
HWY_INLINE std::uint64_t range_bits(std::int64_t first, std::int64_t last) {
  if (last < 0 || first > 7) return 0;
  return (std::uint64_t{0xff} << std::max<std::int64_t>(first, 0)) & 0xff &
         (std::uint64_t{0xff} >> (7 - std::min<std::int64_t>(last, 7)));
}

// Units and derivation are those of TriangleOverlap.
class LargeTriangle {
 public:
  HWY_INLINE explicit LargeTriangle(const LatticeTriangle& corners) : corners_(corners) {
    for (std::size_t d = 0; d < 3; ++d) {
      low_[d] = std::min({corners[0][d], corners[1][d], corners[2][d]}) >> kSnapBits;
      high_[d] = std::max({corners[0][d], corners[1][d], corners[2][d]}) >> kSnapBits;
      for (std::size_t k = 0; k < 3; ++k) sides_[k][d] = corners[(k + 1) % 3][d] - corners[k][d];
    }
    for (std::size_t d = 0; d < 3; ++d) set_up_projection(d);
    normal_[1] = -normal_[1];
    for (std::size_t d = 0; d < 3; ++d) {
      up_ += positive(normal_[d]);
      down_ += negative(normal_[d]);
    }
    for (std::int64_t z = 0; z < 8; ++z) along_z_[static_cast<std::size_t>(z)] = normal_[2] * z;
  }

  // The bricks of the node in the triangle's box, both ends inclusive.
  struct Bricks {
    std::array<unsigned, 3> first, last;
  };
  HWY_INLINE Bricks bricks() const {
    Bricks box;
    for (std::size_t d = 0; d < 3; ++d) {
      if (high_[d] < 0 || low_[d] > 63) return {{1, 1, 1}, {0, 0, 0}};
      box.first[d] = static_cast<unsigned>(std::max<std::int64_t>(low_[d], 0) >> 3);
      box.last[d] = static_cast<unsigned>(std::min<std::int64_t>(high_[d], 63) >> 3);
    }
    return box;
  }

  // The hit ones of 8x8x8 cells of 2^log2_cell voxels an edge; `corner` is the lowest voxel. False
  // where there is none.
  HWY_INLINE bool find_cells(const std::array<std::int64_t, 3>& corner, int log2_cell,
                             BrickMask& hit) const {
    std::array<std::uint64_t, 3> range;
    for (std::size_t d = 0; d < 3; ++d) {
      range[d] =
          range_bits((low_[d] - corner[d]) >> log2_cell, (high_[d] - corner[d]) >> log2_cell);
      if (range[d] == 0) return false;
    }
    std::array<std::uint64_t, 3> shadow;
    for (std::size_t d = 0; d < 3; ++d) {
      shadow[d] = shadow_cells(d, corner, log2_cell);
      if (shadow[d] == 0) return false;
    }
    return cut_by_plane(corner, log2_cell, range, shadow, hit);
  }

 private:
  struct Edge {
    std::int64_t a, b;  // a u + b w >= value on the triangle's side
    std::int64_t value;
  };

  HWY_INLINE void set_up_projection(std::size_t d) {
    const std::size_t u = kU[d], w = kW[d];
    // sides_[2] runs from corner 2 back to corner 0.
    const std::int64_t area = sides_[0][w] * sides_[2][u] - sides_[0][u] * sides_[2][w];
    normal_[d] = area;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int64_t sign = area < 0 ? -1 : 1;
      edges_[d][k] =
          edge(-sign * sides_[k][w], sign * sides_[k][u], corners_[k][u], corners_[k][w]);
    }
    if (area != 0) return;
    // A shadow without area is a segment: its line bounds it from both sides.
    const std::size_t line = sides_[0][u] == 0 && sides_[0][w] == 0 ? 1 : 0;
    const std::int64_t a = -sides_[line][w], b = sides_[line][u];
    edges_[d] = {edge(a, b, corners_[0][u], corners_[0][w]),
                 edge(-a, -b, corners_[0][u], corners_[0][w]), Edge{0, 0, 0}};
  }

  static HWY_INLINE Edge edge(std::int64_t a, std::int64_t b, std::int64_t u0, std::int64_t w0) {
    return {a, b, a * u0 + b * w0};
  }

  HWY_INLINE std::uint64_t shadow_cells(std::size_t d, const std::array<std::int64_t, 3>& corner,
                                        int log2_cell) const {
    const std::int64_t u = corner[kU[d]] * kSnapUnits, w = corner[kW[d]] * kSnapUnits;
    const int shift = kSnapBits + log2_cell;
    std::uint64_t cells = ~std::uint64_t{0};
    for (const Edge& e : edges_[d]) {
      const std::int64_t above = positive(e.a) + positive(e.b),
                         under = negative(e.a) + negative(e.b);
      const std::int64_t value = e.value - e.a * u - e.b * w;
      const std::int64_t least = ceil_shift(value + (above > 0 ? 1 : 0), shift) - above;
      if (least <= 7 * under) continue;  // all cells pass
      if (least > 7 * above) return 0;   // none does
      cells &=
          SquareCells<8>::inside({static_cast<std::int32_t>(e.a), static_cast<std::int32_t>(e.b),
                                  static_cast<std::int32_t>(least - 1)});
    }
    return cells;
  }

  HWY_INLINE bool cut_by_plane(const std::array<std::int64_t, 3>& corner, int log2_cell,
                               const std::array<std::uint64_t, 3>& range,
                               const std::array<std::uint64_t, 3>& shadow, BrickMask& hit) const {
    const int shift = kSnapBits + log2_cell;
    std::int64_t value = 0;
    for (std::size_t d = 0; d < 3; ++d) {
      value += normal_[d] * (corners_[0][d] - corner[d] * kSnapUnits);
    }
    const std::int64_t lo = ceil_shift(value + (up_ > 0 ? 1 : 0), shift) - up_;
    const std::int64_t hi = ((value - (down_ < 0 ? 1 : 0)) >> shift) - down_;
    if (lo > 7 * up_ || hi < 7 * down_) return false;
    // Sums of cells lie between 7 down and 7 up; wrapped to 32 bits, they must not come around to
    // the far side of lo..hi, which is at most as wide as up - down + 1.
    const bool narrow = 8 * (up_ - down_) + 1 < (std::int64_t{1} << 32);
    std::uint64_t any = 0;
    hit = {};
    for (unsigned x = 0; x < 8; ++x) {
      if ((range[0] >> x & 1) == 0) continue;
      const std::uint64_t over_y = shadow[2] >> (8 * x) & range[1];
      const std::uint64_t over_z = shadow[1] >> (8 * x) & range[2];
      std::uint64_t word = shadow[0] & fill_rows(over_y) & over_z * kFirstColumn;
      if (word == 0) continue;
      const std::int64_t offset = normal_[0] * x;
      word &= narrow ? SquareCells<8>::between(static_cast<std::int32_t>(normal_[1]),
                                               static_cast<std::int32_t>(normal_[2]),
                                               static_cast<std::uint32_t>(lo - offset),
                                               static_cast<std::uint32_t>(hi - lo))
                     : between_wide(word, lo - offset, hi - offset);
      hit.words[x] = word;
      any |= word;
    }
    return any != 0;
  }

  // The cells y*8 + z among those `wanted` with lo <= ny y + nz z <= hi, row by row in 64-bit
  // lanes.
  HWY_INLINE std::uint64_t between_wide(std::uint64_t wanted, std::int64_t lo,
                                        std::int64_t hi) const {
    constexpr hn::CappedTag<std::int64_t, 8> kTag{};
    std::uint64_t cells = 0;
    for (int y = 0; y < 8; ++y) {
      if ((wanted >> (8 * y) & 0xff) == 0) continue;
      const std::int64_t offset = normal_[1] * y;
      const auto below = hn::Set(kTag, lo - offset - 1), above = hn::Set(kTag, hi - offset + 1);
      std::uint64_t row = 0;
      for (std::size_t first = 0; first < 8; first += hn::Lanes(kTag)) {
        const auto value = hn::Load(kTag, along_z_.data() + first);
        std::uint64_t part = 0;
        hn::StoreMaskBits(kTag, hn::And(hn::Gt(value, below), hn::Lt(value, above)),
                          reinterpret_cast<std::uint8_t*>(&part));
        row |= part << first;
      }
      cells |= row << (8 * y);
    }
    return cells;
  }

  const LatticeTriangle& corners_;
  std::array<std::int64_t, 3> low_, high_;  // voxels
  std::array<std::array<std::int64_t, 3>, 3> sides_;
  std::array<std::array<Edge, 3>, 3> edges_;
  std::array<std::int64_t, 3> normal_;
  std::int64_t up_ = 0, down_ = 0;  // sums of the normal's positive and negative parts
  alignas(64) std::array<std::int64_t, 8> along_z_;
};

// Marks the voxels of one brick.
HWY_INLINE void draw_brick(const LargeTriangle& triangle, unsigned x, unsigned y, unsigned z,
                           NodeCanvas& canvas) {
  BrickMask voxels;
  if (!triangle.find_cells({8 * x, 8 * y, 8 * z}, 0, voxels)) return;
  BrickMask& target = canvas.brick(x, y, z);
  for (std::size_t i = 0; i < 8; ++i) target.words[i] |= voxels.words[i];
}

void draw_triangle(const LatticeTriangle& corners, NodeCanvas& canvas) {
  constexpr unsigned kFewBricks = 8;  // not worth a test of their own
  const LargeTriangle triangle(corners);
  const auto [first, last] = triangle.bricks();
  if (first[0] > last[0] || first[1] > last[1] || first[2] > last[2]) return;
  if ((last[0] - first[0] + 1) * (last[1] - first[1] + 1) * (last[2] - first[2] + 1) > kFewBricks) {
    BrickMask bricks;
    if (!triangle.find_cells({0, 0, 0}, 3, bricks)) return;
    for_each_cell(bricks, [&](unsigned x, unsigned y, unsigned z)
                              HWY_ATTR { draw_brick(triangle, x, y, z, canvas); });
    return;
  }
  for (unsigned x = first[0]; x <= last[0]; ++x) {
    for (unsigned y = first[1]; y <= last[1]; ++y) {
      for (unsigned z = first[2]; z <= last[2]; ++z) draw_brick(triangle, x, y, z, canvas);
    }
  }
}

}  // namespace
}  // namespace forcelayer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer {
namespace {
HWY_EXPORT(draw_triangle);
}  // namespace

void draw_large_triangle(const LatticeTriangle& corners, NodeCanvas& canvas) {
  HWY_DYNAMIC_DISPATCH(draw_triangle)(corners, canvas);
}

}  // namespace forcelayer
#endif

#include "voxelize/scan/large_triangle.h"

// Compiled once for every instruction set that Highway supports, picked at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/scan/large_triangle.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include "voxelize/scan/square_cells-inl.h"

#include <algorithm>
#include <array>
#include <bit>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::scan::HWY_NAMESPACE {
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

struct Edge {
  std::int64_t a, b;  // a u + b w >= value on the triangle's side
  std::int64_t value;
  std::int64_t above;  // sum of the positive ones of a and b: how far up a cell reaches

  // A cell passes where a u + b w is at least a bound. Of the 8x8 cells all pass where the bound is
  // at most all_pass, none where it exceeds some_pass. `smallest` is the bound for voxels.
  std::int64_t smallest;
  std::int64_t all_pass, some_pass;
  SquareCells::Table sums;

  HWY_INLINE void set_up(std::int64_t of_u, std::int64_t of_w, std::int64_t u0, std::int64_t w0) {
    a = of_u;
    b = of_w;
    value = a * u0 + b * w0;
    above = positive(a) + positive(b);
    smallest = min_sum(lattice::kSnapBits);
    all_pass = 7 * (negative(a) + negative(b));
    some_pass = 7 * above;
    SquareCells::tabulate(static_cast<std::int32_t>(a), static_cast<std::int32_t>(b), sums);
  }
  HWY_INLINE std::int64_t min_sum(int shift) const {
    return ceil_shift(value + (above > 0 ? 1 : 0), shift) - above;
  }
};
using Edges = std::array<Edge, 3>;
using Sides = std::array<std::array<std::int64_t, 3>, 3>;

HWY_INLINE Sides sides_of(const lattice::LatticeTriangle& corners) {
  Sides sides;
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t d = 0; d < 3; ++d) sides[k][d] = corners[(k + 1) % 3][d] - corners[k][d];
  }
  return sides;
}

// The edges of the projection along d. Returns twice its signed area.
HWY_INLINE std::int64_t set_up_projection(const lattice::LatticeTriangle& corners,
                                          const Sides& sides, std::size_t d, Edges& edges) {
  const std::size_t u = kU[d], w = kW[d];
  // sides[2] runs from corner 2 back to corner 0.
  const std::int64_t area = sides[0][w] * sides[2][u] - sides[0][u] * sides[2][w];
  if (area != 0) {
    const std::int64_t sign = area < 0 ? -1 : 1;
    for (std::size_t k = 0; k < 3; ++k) {
      edges[k].set_up(-sign * sides[k][w], sign * sides[k][u], corners[k][u], corners[k][w]);
    }
    return area;
  }
  // A shadow without area is a segment: its line bounds it from both sides.
  const std::size_t line = sides[0][u] == 0 && sides[0][w] == 0 ? 1 : 0;
  const std::int64_t a = -sides[line][w], b = sides[line][u];
  edges[0].set_up(a, b, corners[0][u], corners[0][w]);
  edges[1].set_up(-a, -b, corners[0][u], corners[0][w]);
  edges[2].set_up(0, 0, 0, 0);
  return 0;
}

// The cells of 8x8 that pass all three edges, where least[k] is the least sum that passes edge k.
// Without branches, which would be mispredicted: which edges cut the cells is irregular.
HWY_INLINE std::uint64_t passing(const Edges& edges, const std::array<std::int64_t, 3>& smallest) {
  std::array<std::int32_t, 3> below;
  for (std::size_t k = 0; k < 3; ++k) {
    below[k] = static_cast<std::int32_t>(
        std::clamp(smallest[k], edges[k].all_pass, edges[k].some_pass + 1) - 1);
  }
  return SquareCells::above(edges[0].sums, below[0], edges[1].sums, below[1], edges[2].sums,
                            below[2]);
}

// The voxels (u, w) of 8x8 from (u, w), multiples of 8, that pass all three edges.
HWY_INLINE std::uint64_t shadow_of(const Edges& edges, std::int64_t u, std::int64_t w) {
  std::array<std::int64_t, 3> smallest;
  for (std::size_t k = 0; k < 3; ++k)
    smallest[k] = edges[k].smallest - edges[k].a * u - edges[k].b * w;
  return passing(edges, smallest);
}

// Units and derivation are those of TriangleOverlap.
class LargeTriangle {
 public:
  HWY_INLINE explicit LargeTriangle(const lattice::LatticeTriangle& corners) : corners_(corners) {
    for (std::size_t d = 0; d < 3; ++d) {
      low_[d] = std::min({corners[0][d], corners[1][d], corners[2][d]}) >> lattice::kSnapBits;
      high_[d] = std::max({corners[0][d], corners[1][d], corners[2][d]}) >> lattice::kSnapBits;
    }
    const Sides sides = sides_of(corners);
    for (std::size_t d = 0; d < 3; ++d) {
      normal_[d] = set_up_projection(corners, sides, d, edges_[d]);
    }
    normal_[1] = -normal_[1];
    for (std::size_t d = 0; d < 3; ++d) {
      up_ += positive(normal_[d]);
      down_ += negative(normal_[d]);
      plane_ += normal_[d] * corners_[0][d];
    }
    lo_ = min_sum(plane_, lattice::kSnapBits);
    hi_ = greatest_sum(plane_, lattice::kSnapBits);
    // Sums of cells lie between 7 down and 7 up, and hi - lo is at most up - down + 1. Wrapped to
    // 32 bits, a sum outside lo..hi must not look like one inside.
    narrow_ = 8 * (up_ - down_) + 1 < (std::int64_t{1} << 32);
    SquareCells::tabulate(static_cast<std::int32_t>(normal_[1]),
                          static_cast<std::int32_t>(normal_[2]), plane_sums_);
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

  // The hit voxels of brick (x, y, z) of the node. False where there is none.
  HWY_INLINE bool find_voxels(unsigned x, unsigned y, unsigned z, lattice::BrickMask& hit) const {
    const std::array<std::int64_t, 3> corner = {8 * x, 8 * y, 8 * z};
    std::int64_t offset = 0;
    for (std::size_t d = 0; d < 3; ++d) offset += normal_[d] * corner[d];
    const std::int64_t lo = lo_ - offset, hi = hi_ - offset;
    if (lo > 7 * up_ || hi < 7 * down_) return false;
    std::array<std::uint64_t, 3> shadow;
    for (std::size_t d = 0; d < 3; ++d) {
      shadow[d] = shadow_of(edges_[d], corner[kU[d]], corner[kW[d]]);
      if (shadow[d] == 0) return false;
    }
    return cut_by_plane(ranges(corner, 0), shadow, lo, hi, hit);
  }

  // The hit bricks of the node. False where there is none.
  HWY_INLINE bool find_bricks(lattice::BrickMask& hit) const {
    constexpr int kShift = lattice::kSnapBits + 3;
    const std::int64_t lo = min_sum(plane_, kShift), hi = greatest_sum(plane_, kShift);
    if (lo > 7 * up_ || hi < 7 * down_) return false;
    std::array<std::uint64_t, 3> shadow;
    for (std::size_t d = 0; d < 3; ++d) {
      std::array<std::int64_t, 3> smallest;
      for (std::size_t k = 0; k < 3; ++k) smallest[k] = edges_[d][k].min_sum(kShift);
      shadow[d] = passing(edges_[d], smallest);
    }
    return cut_by_plane(ranges({0, 0, 0}, 3), shadow, lo, hi, hit);
  }

 private:
  // The least and greatest n . i of a cell i that the plane n . p = `value` crosses.
  HWY_INLINE std::int64_t min_sum(std::int64_t value, int shift) const {
    return ceil_shift(value + (up_ > 0 ? 1 : 0), shift) - up_;
  }
  HWY_INLINE std::int64_t greatest_sum(std::int64_t value, int shift) const {
    return ((value - (down_ < 0 ? 1 : 0)) >> shift) - down_;
  }

  // The cells of the triangle's box, along every axis.
  HWY_INLINE std::array<std::uint64_t, 3> ranges(const std::array<std::int64_t, 3>& corner,
                                                 int log2_cell) const {
    std::array<std::uint64_t, 3> range;
    for (std::size_t d = 0; d < 3; ++d) {
      range[d] =
          range_bits((low_[d] - corner[d]) >> log2_cell, (high_[d] - corner[d]) >> log2_cell);
    }
    return range;
  }

  HWY_INLINE bool cut_by_plane(const std::array<std::uint64_t, 3>& range,
                               const std::array<std::uint64_t, 3>& shadow, std::int64_t lo,
                               std::int64_t hi, lattice::BrickMask& hit) const {
    unsigned planes =
        cells_below(shadow[0], shadow[1] & range[2] * kFirstColumn,
                    shadow[2] & range[1] * kFirstColumn & fill_rows(range[0]), hit.words);
    std::uint64_t any = 0;
    for (; planes != 0; planes &= planes - 1) {
      const auto x = static_cast<unsigned>(std::countr_zero(planes));
      std::uint64_t& word = hit.words[x];
      const std::int64_t offset = normal_[0] * x;
      word &= narrow_ ? ~SquareCells::outside(plane_sums_, static_cast<std::uint32_t>(lo - offset),
                                              static_cast<std::uint32_t>(hi - lo))
                      : between_wide(word, lo - offset, hi - offset);
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

  const lattice::LatticeTriangle& corners_;
  std::array<std::int64_t, 3> low_, high_;  // voxels
  std::array<Edges, 3> edges_;
  std::array<std::int64_t, 3> normal_;
  std::int64_t up_ = 0, down_ = 0;  // sums of the normal's positive and negative parts
  std::int64_t plane_ = 0;          // n . corner
  std::int64_t lo_, hi_;            // n . i of voxels that the plane crosses
  bool narrow_;
  SquareCells::Table plane_sums_;
  alignas(64) std::array<std::int64_t, 8> along_z_;
};

// A triangle that lies in one layer of voxels across axis `d` hits those below its projection.
class FlatTriangle {
 public:
  HWY_INLINE FlatTriangle(const lattice::LatticeTriangle& corners, std::size_t d) : d_(d) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low_[axis] =
          std::min({corners[0][axis], corners[1][axis], corners[2][axis]}) >> lattice::kSnapBits;
      high_[axis] =
          std::max({corners[0][axis], corners[1][axis], corners[2][axis]}) >> lattice::kSnapBits;
    }
    set_up_projection(corners, sides_of(corners), d, edges_);
  }

  HWY_INLINE void draw(NodeCanvas& canvas) const {
    const std::size_t u = kU[d_], w = kW[d_];
    if (low_[d_] < 0 || low_[d_] > 63 || high_[u] < 0 || low_[u] > 63 || high_[w] < 0 ||
        low_[w] > 63) {
      return;
    }
    const std::int64_t last_u = std::min<std::int64_t>(high_[u], 63) & ~7,
                       last_w = std::min<std::int64_t>(high_[w], 63) & ~7;
    for (std::int64_t at_u = std::max<std::int64_t>(low_[u], 0) & ~7; at_u <= last_u; at_u += 8) {
      for (std::int64_t at_w = std::max<std::int64_t>(low_[w], 0) & ~7; at_w <= last_w; at_w += 8) {
        const std::uint64_t cells = shadow_of(edges_, at_u, at_w) &
                                    fill_rows(range_bits(low_[u] - at_u, high_[u] - at_u)) &
                                    range_bits(low_[w] - at_w, high_[w] - at_w) * kFirstColumn;
        if (cells != 0) {
          add(cells, static_cast<unsigned>(at_u >> 3), static_cast<unsigned>(at_w >> 3), canvas);
        }
      }
    }
  }

 private:
  // Voxels (u, w) of brick (u, w), in the triangle's layer.
  HWY_INLINE void add(std::uint64_t cells, unsigned u, unsigned w, NodeCanvas& canvas) const {
    const auto layer = static_cast<unsigned>(low_[d_]);
    if (d_ == 0) {
      canvas.brick(layer >> 3, u, w).words[layer & 7] |= cells;
      return;
    }
    lattice::BrickMask& brick =
        d_ == 1 ? canvas.brick(u, layer >> 3, w) : canvas.brick(u, w, layer >> 3);
    for (unsigned x = 0; x < 8; ++x) {
      const std::uint64_t row = cells >> (8 * x) & 0xff;
      brick.words[x] |=
          d_ == 1 ? row << (8 * (layer & 7)) : fill_rows(row) & kFirstColumn << (layer & 7);
    }
  }

  std::size_t d_;
  std::array<std::int64_t, 3> low_, high_;  // voxels
  Edges edges_;
};

// Marks the voxels of one brick.
HWY_INLINE void draw_brick(const LargeTriangle& triangle, unsigned x, unsigned y, unsigned z,
                           NodeCanvas& canvas) {
  lattice::BrickMask voxels;
  if (!triangle.find_voxels(x, y, z, voxels)) return;
  lattice::BrickMask& target = canvas.brick(x, y, z);
  for (std::size_t i = 0; i < 8; ++i) target.words[i] |= voxels.words[i];
}

void draw_triangle(const lattice::LatticeTriangle& corners, NodeCanvas& canvas) {
  for (std::size_t d = 0; d < 3; ++d) {
    const std::int64_t layer = corners[0][d] >> lattice::kSnapBits;
    if (corners[1][d] >> lattice::kSnapBits == layer &&
        corners[2][d] >> lattice::kSnapBits == layer) {
      return FlatTriangle(corners, d).draw(canvas);
    }
  }
  constexpr unsigned kFewBricks = 18;  // not worth a test of their own
  const LargeTriangle triangle(corners);
  const auto [first, last] = triangle.bricks();
  if (first[0] > last[0] || first[1] > last[1] || first[2] > last[2]) return;
  if ((last[0] - first[0] + 1) * (last[1] - first[1] + 1) * (last[2] - first[2] + 1) > kFewBricks) {
    lattice::BrickMask bricks;
    if (!triangle.find_bricks(bricks)) return;
    lattice::for_each_cell(bricks, [&](unsigned x, unsigned y, unsigned z)
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
}  // namespace forcelayer::scan::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::scan {
namespace {
HWY_EXPORT(draw_triangle);
}  // namespace

void draw_large_triangle(const lattice::LatticeTriangle& corners, NodeCanvas& canvas) {
  HWY_DYNAMIC_DISPATCH(draw_triangle)(corners, canvas);
}

}  // namespace forcelayer::scan
#endif

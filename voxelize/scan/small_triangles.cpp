#include "voxelize/scan/small_triangles.h"

// Compiled once for every instruction set that Highway supports; draw() picks one at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/scan/small_triangles.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include "voxelize/scan/square_cells-inl.h"

#include <algorithm>
#include <bit>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::scan::HWY_NAMESPACE {
namespace {

using hn::Add;
using hn::IfThenElse;
using hn::Lt;
using hn::Max;
using hn::Min;
using hn::Mul;
using hn::Neg;
using hn::ShiftRight;
using hn::Sub;

constexpr hn::CappedTag<std::int32_t, SmallTriangles::kCapacity> kLanes;
using Vector = hn::Vec<decltype(kLanes)>;
using Vector3 = std::array<Vector, 3>;
using Lanes = SmallTriangles::Lanes;

// Every triangle's tests in its own window, which starts at the lowest of its voxels. Units and
// derivation are those of TriangleOverlap.
struct alignas(64) WindowTests {
  std::array<Lanes, 3> low;     // lowest voxel, from the node's lowest
  std::array<Lanes, 3> span;    // voxels beyond the lowest
  std::array<Lanes, 3> normal;  // twice the area vector
  std::array<Lanes, 3> anchor;  // corner 0 in the window, lattice units
  struct Edge {
    Lanes a, b, below;  // a cell (u, w) passes where a u + b w > below
  };
  std::array<std::array<Edge, 3>, 3> edges;  // of the projections along x, y and z
};

constexpr std::size_t kU[3] = {1, 0, 0}, kW[3] = {2, 2, 1};  // axes of the projections

HWY_INLINE Vector load(const Lanes& lanes, std::size_t first) {
  return hn::Load(kLanes, lanes.data() + first);
}
HWY_INLINE void store(Vector value, Lanes& lanes, std::size_t first) {
  hn::Store(value, kLanes, lanes.data() + first);
}

HWY_INLINE void prepare_edge(Vector a, Vector b, Vector u0, Vector w0, std::size_t first,
                             WindowTests::Edge& edge) {
  const Vector zero = hn::Zero(kLanes);
  const Vector reach = Add(Max(a, zero), Max(b, zero));
  const Vector value = Add(Mul(a, u0), Mul(b, w0));
  // The least a u + b w is ceil((value + open) / 2^10) - reach, open = 1 where reach > 0.
  const Vector open = Min(reach, hn::Set(kLanes, 1));
  const Vector rounded = ShiftRight<lattice::kSnapBits>(
      Add(Add(value, open), hn::Set(kLanes, int{lattice::kSnapUnits} - 1)));
  store(a, edge.a, first);
  store(b, edge.b, first);
  store(Sub(rounded, Add(reach, hn::Set(kLanes, 1))), edge.below, first);
}

// Edges of one projection; `area` is twice its signed area. A shadow without area is a segment: its
// line bounds it from both sides, and the third edge lets everything pass.
HWY_INLINE void prepare_projection(const std::array<Vector3, 3>& corners,
                                   const std::array<Vector3, 3>& sides, Vector area, std::size_t d,
                                   std::size_t first, WindowTests& tests) {
  const std::size_t u = kU[d], w = kW[d];
  const Vector zero = hn::Zero(kLanes);
  const auto negative = Lt(area, zero);
  const auto flat = hn::Eq(area, zero);
  const auto short_edge = hn::Eq(hn::Or(sides[0][u], sides[0][w]), zero);
  const Vector line_u = IfThenElse(short_edge, sides[1][u], sides[0][u]);
  const Vector line_w = IfThenElse(short_edge, sides[1][w], sides[0][w]);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vector side_u = sides[k][u], side_w = sides[k][w];
    Vector a = IfThenElse(negative, side_w, Neg(side_w));
    Vector b = IfThenElse(negative, Neg(side_u), side_u);
    const Vector flat_a = k == 0 ? Neg(line_w) : k == 1 ? line_w : zero;
    const Vector flat_b = k == 0 ? line_u : k == 1 ? Neg(line_u) : zero;
    a = IfThenElse(flat, flat_a, a);
    b = IfThenElse(flat, flat_b, b);
    const Vector u0 = IfThenElse(flat, corners[0][u], corners[k][u]);
    const Vector w0 = IfThenElse(flat, corners[0][w], corners[k][w]);
    prepare_edge(a, b, u0, w0, first, tests.edges[d][k]);
  }
}

HWY_INLINE void prepare(const SmallTriangles::Corners& units, std::size_t first,
                        WindowTests& tests) {
  std::array<Vector3, 3> corners, sides;
  for (std::size_t d = 0; d < 3; ++d) {
    for (std::size_t k = 0; k < 3; ++k) corners[k][d] = load(units[k][d], first);
    const Vector smallest = Min(corners[0][d], Min(corners[1][d], corners[2][d]));
    const Vector largest = Max(corners[0][d], Max(corners[1][d], corners[2][d]));
    const Vector low = ShiftRight<lattice::kSnapBits>(smallest);
    store(low, tests.low[d], first);
    store(Sub(ShiftRight<lattice::kSnapBits>(largest), low), tests.span[d], first);
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k][d] = Sub(corners[k][d], hn::ShiftLeft<lattice::kSnapBits>(low));
    }
    for (std::size_t k = 0; k < 3; ++k) sides[k][d] = Sub(corners[(k + 1) % 3][d], corners[k][d]);
    store(corners[0][d], tests.anchor[d], first);
  }
  // sides[2] runs from corner 2 back to corner 0.
  const auto area = [&](std::size_t u, std::size_t w) {
    return Sub(Mul(sides[0][w], sides[2][u]), Mul(sides[0][u], sides[2][w]));
  };
  const Vector3 areas = {area(1, 2), area(0, 2), area(0, 1)};
  store(areas[0], tests.normal[0], first);
  store(Neg(areas[1]), tests.normal[1], first);
  store(areas[2], tests.normal[2], first);
  for (std::size_t d = 0; d < 3; ++d) {
    prepare_projection(corners, sides, areas[d], d, first, tests);
  }
}

HWY_INLINE HalfPlane half_plane(const WindowTests::Edge& edge, std::size_t t) {
  return {edge.a[t], edge.b[t], edge.below[t]};
}

// Where triangle t's shadow is, as bits u*8 + w.
HWY_INLINE std::uint64_t shadow(const std::array<WindowTests::Edge, 3>& edges, std::size_t t) {
  return SquareCells::inside(half_plane(edges[0], t), half_plane(edges[1], t),
                             half_plane(edges[2], t));
}

// A triangle's window, cell (x, y, z) as bit y*8 + z of word x.
using Window = std::array<std::uint64_t, 8>;

// Rows of kSide bits to rows of eight.
template <unsigned kSide>
HWY_INLINE std::uint64_t widen_rows(std::uint64_t bits) {
  if constexpr (kSide == 2) return (bits & 0x3) | (bits & 0xc) << 6;
  return (bits & 0xf) | (bits & 0xf0) << 4 | (bits & 0xf00) << 8 | (bits & 0xf000) << 12;
}

// The bounds of n . i over the window's cells that the triangle's plane crosses: lo .. lo + width.
struct Bounds {
  std::int32_t lo;
  std::uint32_t width;
};
HWY_INLINE Bounds plane_bounds(const WindowTests& tests, std::size_t t) {
  std::int64_t value = 0, up = 0, down = 0;
  for (std::size_t d = 0; d < 3; ++d) {
    const std::int64_t n = tests.normal[d][t];
    value += n * tests.anchor[d][t];
    up += std::max<std::int64_t>(n, 0);
    down += std::min<std::int64_t>(n, 0);
  }
  const std::int64_t lo =
      ((value + (up > 0 ? 1 : 0) + lattice::kSnapUnits - 1) >> lattice::kSnapBits) - up;
  const std::int64_t hi = ((value - (down < 0 ? 1 : 0)) >> lattice::kSnapBits) - down;
  return {static_cast<std::int32_t>(lo), static_cast<std::uint32_t>(hi - lo)};
}

// The hit cells of a triangle of at most 8 voxels along every axis.
HWY_INLINE void find_cells(const WindowTests& tests, std::size_t t, Window& window) {
  const unsigned span_x = static_cast<unsigned>(tests.span[0][t]);
  const std::uint64_t rows_y = (std::uint64_t{2} << tests.span[1][t]) - 1;
  const std::uint64_t columns_z = (std::uint64_t{2} << tests.span[2][t]) - 1;
  // A triangle in one layer of voxels hits those below its projection.
  if (span_x == 0) {
    window[0] = shadow(tests.edges[0], t) & fill_rows(rows_y) & columns_z * kFirstColumn;
    return;
  }
  if (tests.span[1][t] == 0) {
    const std::uint64_t cells = shadow(tests.edges[1], t) & columns_z * kFirstColumn;
    for (unsigned x = 0; x <= span_x; ++x) window[x] = cells >> (8 * x) & 0xff;
    return;
  }
  if (tests.span[2][t] == 0) {
    const std::uint64_t cells = shadow(tests.edges[2], t) & rows_y * kFirstColumn;
    for (unsigned x = 0; x <= span_x; ++x) window[x] = fill_rows(cells >> (8 * x)) & kFirstColumn;
    return;
  }
  const std::uint64_t along_x = shadow(tests.edges[0], t);
  const std::uint64_t along_y = shadow(tests.edges[1], t);  // x*8 + z
  const std::uint64_t along_z = shadow(tests.edges[2], t);  // x*8 + y
  const Bounds bounds = plane_bounds(tests, t);
  const std::int32_t nx = tests.normal[0][t], ny = tests.normal[1][t], nz = tests.normal[2][t];
  unsigned planes = cells_below(
      along_x, along_y & columns_z * kFirstColumn,
      along_z & rows_y * kFirstColumn & (~std::uint64_t{0} >> (56 - 8 * span_x)), window);
  SquareCells::Table plane_sums;
  SquareCells::tabulate(ny, nz, plane_sums);
  for (; planes != 0; planes &= planes - 1) {
    const auto x = static_cast<unsigned>(std::countr_zero(planes));
    const auto lo = static_cast<std::uint32_t>(bounds.lo - nx * static_cast<std::int32_t>(x));
    window[x] &= ~SquareCells::outside(plane_sums, lo, bounds.width);
  }
}

// Where all three edges' tests pass, cell (u, w) as bit u*kSide + w, triangle by triangle.
template <unsigned kSide>
HWY_INLINE Vector shadows(const std::array<WindowTests::Edge, 3>& edges, std::size_t first) {
  std::array<Vector, 3> row, step_u, step_w;  // values less `below`
  for (std::size_t k = 0; k < 3; ++k) {
    step_u[k] = load(edges[k].a, first);
    step_w[k] = load(edges[k].b, first);
    row[k] = Neg(load(edges[k].below, first));
  }
  const Vector zero = hn::Zero(kLanes);
  Vector bits = zero;
  for (unsigned u = 0; u < kSide; ++u) {
    std::array<Vector, 3> cell = row;
    for (unsigned w = 0; w < kSide; ++w) {
      const auto inside = hn::Gt(Min(Min(cell[0], cell[1]), cell[2]), zero);
      bits = hn::Or(bits, hn::IfThenElseZero(inside, hn::Set(kLanes, 1 << (u * kSide + w))));
      for (std::size_t k = 0; k < 3; ++k) cell[k] = Add(cell[k], step_w[k]);
    }
    for (std::size_t k = 0; k < 3; ++k) row[k] = Add(row[k], step_u[k]);
  }
  return bits;
}

// The bounds of n . i over the cells that a triangle's plane crosses, in 32 bits: with corners in
// at most 4 voxels, products of a normal's halves and an anchor's fit.
struct LaneBounds {
  Vector lo, width;
};
HWY_INLINE LaneBounds lane_bounds(const WindowTests& tests, std::size_t first) {
  const Vector zero = hn::Zero(kLanes), one = hn::Set(kLanes, 1);
  const Vector fraction = hn::Set(kLanes, int{lattice::kSnapUnits} - 1);
  Vector whole = zero, rest = zero;  // n . anchor is 2^10 whole + rest
  Vector up = zero, down = zero;
  for (std::size_t d = 0; d < 3; ++d) {
    const Vector n = load(tests.normal[d], first), at = load(tests.anchor[d], first);
    const Vector n_high = ShiftRight<lattice::kSnapBits>(n), n_low = hn::And(n, fraction);
    const Vector at_high = ShiftRight<lattice::kSnapBits>(at), at_low = hn::And(at, fraction);
    whole = Add(whole, Add(Mul(n, at_high), Mul(n_high, at_low)));
    rest = Add(rest, Mul(n_low, at_low));
    up = Add(up, Max(n, zero));
    down = Add(down, Min(n, zero));
  }
  const Vector open_up = Min(up, one), open_down = Max(down, Neg(one));
  const Vector lo =
      Sub(Add(whole, ShiftRight<lattice::kSnapBits>(Add(Add(rest, open_up), fraction))), up);
  const Vector hi = Sub(Add(whole, ShiftRight<lattice::kSnapBits>(Add(rest, open_down))), down);
  return {lo, Sub(hi, lo)};
}

// One bit for each of kSide cells, in every kSide-th place, and kSide bits for each.
template <unsigned kSide>
constexpr std::int32_t kColumn = kSide == 2 ? 0x5 : 0x1111;
template <unsigned kSide>
HWY_INLINE Vector filled_rows(Vector bits) {
  Vector spread = bits;
  for (unsigned i = 1; i < kSide; ++i) {
    spread = hn::Or(spread, hn::ShiftLeftSame(bits, static_cast<int>(i * (kSide - 1))));
  }
  const Vector firsts = hn::And(spread, hn::Set(kLanes, kColumn<kSide>));
  return Sub(hn::ShiftLeft<kSide>(firsts), firsts);
}

// The hit cells of triangles of at most kSide voxels along every axis, kSide 2 or 4: cell (x, y, z)
// as bit y*kSide + z of the triangle's lane of words[x].
template <unsigned kSide>
HWY_INLINE void find_cells_in_lanes(const WindowTests& tests, std::size_t first,
                                    std::array<Lanes, kSide>& words) {
  constexpr int kRow = (1 << kSide) - 1;
  const Vector row = hn::Set(kLanes, kRow), two = hn::Set(kLanes, 2), one = hn::Set(kLanes, 1);
  const auto range = [&](std::size_t d)
                         HWY_ATTR { return Sub(hn::Shl(two, load(tests.span[d], first)), one); };
  const Vector rows_y = range(1), columns_z = range(2);
  const Vector along_x = shadows<kSide>(tests.edges[0], first);
  Vector along_y = shadows<kSide>(tests.edges[1], first);  // x*kSide + z
  Vector along_z = shadows<kSide>(tests.edges[2], first);  // x*kSide + y

  const LaneBounds bounds = lane_bounds(tests, first);
  constexpr hn::RebindToUnsigned<decltype(kLanes)> kUnsigned;
  const auto width = hn::BitCast(kUnsigned, bounds.width);
  const Vector nx = load(tests.normal[0], first), ny = load(tests.normal[1], first),
               nz = load(tests.normal[2], first);
  Vector plane = Neg(bounds.lo);
  for (unsigned x = 0; x < kSide; ++x) {
    Vector bits = hn::Zero(kLanes), line = plane;
    for (unsigned y = 0; y < kSide; ++y) {
      Vector cell = line;
      for (unsigned z = 0; z < kSide; ++z) {
        const auto outside = hn::RebindMask(kLanes, hn::Gt(hn::BitCast(kUnsigned, cell), width));
        bits = hn::Or(bits, hn::IfThenZeroElse(outside, hn::Set(kLanes, 1 << (y * kSide + z))));
        cell = Add(cell, nz);
      }
      line = Add(line, ny);
    }
    plane = Add(plane, nx);
    const Vector y = hn::And(hn::And(along_z, row), rows_y);
    const Vector z = hn::And(hn::And(along_y, row), columns_z);
    along_z = ShiftRight<kSide>(along_z);
    along_y = ShiftRight<kSide>(along_y);
    const Vector columns = Mul(z, hn::Set(kLanes, kColumn<kSide>));
    store(hn::And(hn::And(bits, along_x), hn::And(filled_rows<kSide>(y), columns)), words[x],
          first);
  }
}

// Moves a window into the bricks of the canvas below it.
class WindowMover {
 public:
  HWY_INLINE WindowMover(const WindowTests& tests, std::size_t t, NodeCanvas& canvas)
      : canvas_(canvas) {
    for (std::size_t d = 0; d < 3; ++d) {
      low_[d] = tests.low[d][t];
      span_[d] = tests.span[d][t];
    }
  }

  HWY_INLINE void move(const Window& window) {
    const int oy = low_[1] & 7, oz = low_[2] & 7;
    const int by = low_[1] >> 3, bz = low_[2] >> 3;
    const bool crosses_y = oy + span_[1] > 7, crosses_z = oz + span_[2] > 7;
    const std::uint64_t stays = (0xffu >> oz) * kFirstColumn;  // columns that stay in the brick
    for (int x = 0; x <= span_[0]; ++x) {
      const std::uint64_t word = window[static_cast<std::size_t>(x)];
      const std::uint64_t near = (word & stays) << oz;
      add(low_[0] + x, by, bz, near << 8 * oy);
      if (crosses_y) add(low_[0] + x, by + 1, bz, near >> (64 - 8 * oy));
      if (!crosses_z) continue;
      const std::uint64_t far = (word & ~stays) >> (8 - oz);
      add(low_[0] + x, by, bz + 1, far << 8 * oy);
      if (crosses_y) add(low_[0] + x, by + 1, bz + 1, far >> (64 - 8 * oy));
    }
  }

 private:
  // Voxels of plane x of the node, in brick row (by, bz); beyond the node they are lost.
  HWY_INLINE void add(int x, int by, int bz, std::uint64_t word) {
    if (word == 0 || static_cast<unsigned>(x) > 63 || static_cast<unsigned>(by) > 7 ||
        static_cast<unsigned>(bz) > 7) {
      return;
    }
    canvas_
        .brick(static_cast<unsigned>(x) >> 3, static_cast<unsigned>(by), static_cast<unsigned>(bz))
        .words[static_cast<unsigned>(x) & 7] |= word;
  }

  NodeCanvas& canvas_;
  std::array<int, 3> low_, span_;
};

template <unsigned kSide>
HWY_INLINE void draw_windows(const WindowTests& tests, std::size_t count, NodeCanvas& canvas) {
  Window window;
  if constexpr (kSide == 8) {
    for (std::size_t t = 0; t < count; ++t) {
      find_cells(tests, t, window);
      WindowMover(tests, t, canvas).move(window);
    }
  } else {
    alignas(64) std::array<Lanes, kSide> words;
    for (std::size_t first = 0; first < count; first += hn::Lanes(kLanes)) {
      find_cells_in_lanes<kSide>(tests, first, words);
    }
    for (std::size_t t = 0; t < count; ++t) {
      for (unsigned x = 0; x < kSide; ++x) {
        window[x] = widen_rows<kSide>(static_cast<std::uint32_t>(words[x][t]));
      }
      WindowMover(tests, t, canvas).move(window);
    }
  }
}

void draw_batch(const SmallTriangles::Batch& batch, unsigned side, NodeCanvas& canvas) {
  WindowTests tests;
  for (std::size_t first = 0; first < batch.count; first += hn::Lanes(kLanes)) {
    prepare(batch.corners, first, tests);
  }
  switch (side) {
    case 2:
      return draw_windows<2>(tests, batch.count, canvas);
    case 4:
      return draw_windows<4>(tests, batch.count, canvas);
    default:
      return draw_windows<8>(tests, batch.count, canvas);
  }
}

}  // namespace
}  // namespace forcelayer::scan::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::scan {
namespace {

HWY_EXPORT(draw_batch);

// A triangle whose box is a row of voxels hits them all; those outside the node are lost.
void draw_row(const std::array<int, 3>& low, const std::array<int, 3>& high, NodeCanvas& canvas) {
  for (int x = low[0]; x <= high[0]; ++x) {
    for (int y = low[1]; y <= high[1]; ++y) {
      for (int z = low[2]; z <= high[2]; ++z) {
        if (((x | y | z) & ~63) != 0) continue;
        const auto ux = static_cast<unsigned>(x), uy = static_cast<unsigned>(y),
                   uz = static_cast<unsigned>(z);
        canvas.brick(ux >> 3, uy >> 3, uz >> 3).words[ux & 7] |= std::uint64_t{1}
                                                                 << ((uy & 7) << 3 | (uz & 7));
      }
    }
  }
}

}  // namespace

void SmallTriangles::draw_batch(std::size_t number, NodeCanvas& canvas) {
  HWY_DYNAMIC_DISPATCH(draw_batch)(batches_[number], 2u << number, canvas);
  batches_[number].count = 0;
}

void SmallTriangles::draw(const lattice::LatticeTriangle& corners, const std::array<int, 3>& low,
                          const std::array<int, 3>& high, NodeCanvas& canvas) {
  const int x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
  if ((x > 0) + (y > 0) + (z > 0) <= 1) return draw_row(low, high, canvas);
  const std::size_t number = (x | y | z) < 2 ? 0 : (x | y | z) < 4 ? 1 : 2;
  Batch& batch = batches_[number];
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t d = 0; d < 3; ++d) {
      batch.corners[k][d][batch.count] = static_cast<std::int32_t>(corners[k][d]);
    }
  }
  if (++batch.count == kCapacity) draw_batch(number, canvas);
}

void SmallTriangles::finish(NodeCanvas& canvas) {
  for (std::size_t number = 0; number < batches_.size(); ++number) {
    if (batches_[number].count > 0) draw_batch(number, canvas);
  }
}

}  // namespace forcelayer::scan
#endif

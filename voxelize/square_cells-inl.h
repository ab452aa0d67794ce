// Tests of square cells in vector lanes. Included once per instruction set (see Highway).
#if defined(FORCELAYER_VOXELIZE_SQUARE_CELLS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FORCELAYER_VOXELIZE_SQUARE_CELLS_INL_H
#undef FORCELAYER_VOXELIZE_SQUARE_CELLS_INL_H
#else
#define FORCELAYER_VOXELIZE_SQUARE_CELLS_INL_H
#endif

#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// A cell (i, j) passes where a i + b j > below.
struct HalfPlane {
  std::int32_t a, b, below;
};

// kSide x kSide cells (i, j) as bits i*kSide + j, a vector of consecutive cells at a time.
template <unsigned kSide>
class SquareCells {
 public:
  // Where all three pass.
  static HWY_INLINE std::uint64_t inside(const HalfPlane& p, const HalfPlane& q,
                                         const HalfPlane& r) {
    std::uint64_t all = 0;
    for (std::size_t first = 0; first < kCells; first += hn::Lanes(kTag)) {
      const SquareCells cells(first);
      all |= bits(hn::And(hn::And(cells.passes(p), cells.passes(q)), cells.passes(r)), first);
    }
    return all;
  }

  static HWY_INLINE std::uint64_t inside(const HalfPlane& p) {
    std::uint64_t all = 0;
    for (std::size_t first = 0; first < kCells; first += hn::Lanes(kTag)) {
      all |= bits(SquareCells(first).passes(p), first);
    }
    return all;
  }

  // Where lo <= a i + b j <= hi.
  static HWY_INLINE std::uint64_t between(std::int32_t a, std::int32_t b, std::int32_t lo,
                                          std::int32_t hi) {
    std::uint64_t all = 0;
    for (std::size_t first = 0; first < kCells; first += hn::Lanes(kTag)) {
      const V value = SquareCells(first).sum(a, b);
      all |=
          bits(hn::And(hn::Gt(value, hn::Set(kTag, lo - 1)), hn::Lt(value, hn::Set(kTag, hi + 1))),
               first);
    }
    return all;
  }

 private:
  static constexpr std::size_t kCells = kSide * kSide;
  static constexpr int kLog2Side = kSide == 8 ? 3 : 2;
  static_assert(kSide == 4 || kSide == 8);
  static constexpr hn::CappedTag<std::int32_t, 16> kTag{};
  using V = hn::Vec<decltype(kTag)>;
  using M = hn::Mask<decltype(kTag)>;

  HWY_INLINE explicit SquareCells(std::size_t first) {
    const V n = hn::Iota(kTag, static_cast<std::int32_t>(first));
    i_ = hn::ShiftRight<kLog2Side>(n);
    j_ = hn::And(n, hn::Set(kTag, static_cast<std::int32_t>(kSide) - 1));
  }

  HWY_INLINE V sum(std::int32_t a, std::int32_t b) const {
    return hn::Add(hn::Mul(hn::Set(kTag, a), i_), hn::Mul(hn::Set(kTag, b), j_));
  }
  HWY_INLINE M passes(const HalfPlane& p) const {
    return hn::Gt(sum(p.a, p.b), hn::Set(kTag, p.below));
  }
  static HWY_INLINE std::uint64_t bits(M mask, std::size_t first) {
    std::uint64_t part = 0;
    hn::StoreMaskBits(kTag, mask, reinterpret_cast<std::uint8_t*>(&part));
    return part << first;
  }

  V i_, j_;  // of the cells from `first` on
};

constexpr std::uint64_t kFirstColumn = 0x0101010101010101u;  // bit z = 0 of all eight rows

// Bit i of the low eight fills byte i.
HWY_INLINE std::uint64_t fill_rows(std::uint64_t bits) {
  const std::uint64_t picked = (bits & 0xff) * kFirstColumn & 0x8040201008040201u;
  return ((picked + 0x7f7f7f7f7f7f7f7fu) >> 7 & kFirstColumn) * 0xff;
}

}  // namespace
}  // namespace forcelayer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

// Tests of square cells in vector lanes. Included once per instruction set (see Highway).
#if defined(FORCELAYER_VOXELIZE_SQUARE_CELLS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FORCELAYER_VOXELIZE_SQUARE_CELLS_INL_H
#undef FORCELAYER_VOXELIZE_SQUARE_CELLS_INL_H
#else
#define FORCELAYER_VOXELIZE_SQUARE_CELLS_INL_H
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::scan::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// A cell (i, j) passes where a i + b j > below.
struct HalfPlane {
  std::int32_t a, b, below;
};

// 8x8 cells (i, j) as bits i*8 + j, a vector of consecutive cells at a time.
class SquareCells {
 public:
  static constexpr std::size_t kCells = 64;
  struct alignas(64) Table {  // a i + b j of every cell; sums may wrap around
    std::array<std::int32_t, kCells> sums;
  };

  static HWY_INLINE void tabulate(std::int32_t a, std::int32_t b, Table& table) {
    Sums sums(a, b);
    for (std::size_t first = 0; first < kCells; first += hn::Lanes(kTag)) {
      hn::Store(sums.at(first), kTag, table.sums.data() + first);
    }
  }

  // Where all three pass.
  static HWY_INLINE std::uint64_t inside(const HalfPlane& p, const HalfPlane& q,
                                         const HalfPlane& r) {
    Sums of_p(p.a, p.b), of_q(q.a, q.b), of_r(r.a, r.b);
    const V below_p = set(p.below), below_q = set(q.below), below_r = set(r.below);
    return for_all_cells([&](std::size_t first) HWY_ATTR {
      return hn::And(hn::And(hn::Gt(of_p.at(first), below_p), hn::Gt(of_q.at(first), below_q)),
                     hn::Gt(of_r.at(first), below_r));
    });
  }

  // Where the sum is more than `below`, in all three tables.
  static HWY_INLINE std::uint64_t above(const Table& p, std::int32_t below_p, const Table& q,
                                        std::int32_t below_q, const Table& r,
                                        std::int32_t below_r) {
    const V limit_p = set(below_p), limit_q = set(below_q), limit_r = set(below_r);
    return for_all_cells([&](std::size_t first) HWY_ATTR {
      return hn::And(hn::And(hn::Gt(loaded(p, first), limit_p), hn::Gt(loaded(q, first), limit_q)),
                     hn::Gt(loaded(r, first), limit_r));
    });
  }

  // Where not lo <= sum <= lo + width. Sums may wrap around if every true sum lies less than
  // 2^32 - width from lo.
  static HWY_INLINE std::uint64_t outside(const Table& table, std::uint32_t lo,
                                          std::uint32_t width) {
    const V first_inside = set(static_cast<std::int32_t>(lo));
    const auto beyond = hn::Set(kUnsigned, width);
    return for_all_cells([&](std::size_t first) HWY_ATTR {
      const auto above_lo = hn::BitCast(kUnsigned, hn::Sub(loaded(table, first), first_inside));
      return hn::RebindMask(kTag, hn::Gt(above_lo, beyond));
    });
  }

 private:
  static constexpr hn::CappedTag<std::int32_t, 16> kTag{};
  static constexpr hn::RebindToUnsigned<decltype(kTag)> kUnsigned{};
  using V = hn::Vec<decltype(kTag)>;

  static HWY_INLINE V set(std::int32_t value) { return hn::Set(kTag, value); }
  static HWY_INLINE V loaded(const Table& table, std::size_t first) {
    return hn::Load(kTag, table.sums.data() + first);
  }

  // The sums a i + b j of a vector of cells. at() is called for ascending cells.
  class Sums {
   public:
    HWY_INLINE Sums(std::int32_t a, std::int32_t b) : a_(a), b_(b) { value_ = computed(0); }
    HWY_INLINE V at(std::size_t first) {
      const std::size_t lanes = hn::Lanes(kTag);
      if (lanes < 8) return computed(first);
      // Whole rows: the next vector is some steps along i further. Sums may wrap around.
      const V value = value_;
      const auto step = static_cast<std::uint32_t>(a_) * static_cast<std::uint32_t>(lanes / 8);
      value_ = hn::Add(value_, set(static_cast<std::int32_t>(step)));
      return value;
    }

   private:
    HWY_INLINE V computed(std::size_t first) const {
      const V n = hn::Iota(kTag, static_cast<std::int32_t>(first));
      const V i = hn::ShiftRight<3>(n);
      const V j = hn::And(n, set(7));
      return hn::Add(hn::Mul(set(a_), i), hn::Mul(set(b_), j));
    }
    std::int32_t a_, b_;
    V value_;
  };

  template <class Pass>
  static HWY_INLINE std::uint64_t for_all_cells(Pass&& pass) {
    std::uint64_t all = 0;
    for (std::size_t first = 0; first < kCells; first += hn::Lanes(kTag)) {
      std::uint16_t part = 0;  // as wide as the widest vector's mask
      hn::StoreMaskBits(kTag, pass(first), reinterpret_cast<std::uint8_t*>(&part));
      all |= std::uint64_t{part} << first;
    }
    return all;
  }
};

constexpr std::uint64_t kFirstColumn = 0x0101010101010101u;  // bit z = 0 of all eight rows

// Bit i of the low eight fills byte i.
HWY_INLINE std::uint64_t fill_rows(std::uint64_t bits) {
  const std::uint64_t picked = (bits & 0xff) * kFirstColumn & 0x8040201008040201u;
  return ((picked + 0x7f7f7f7f7f7f7f7fu) >> 7 & kFirstColumn) * 0xff;
}

// The cells (x, y, z) of a cube of 8 that lie in all three shadows, as bit y*8 + z of word x.
// Shadows: along x bits y*8 + z, along y bits x*8 + z, along z bits x*8 + y. Returns which words
// are not zero, as bits.
HWY_INLINE unsigned cells_below(std::uint64_t along_x, std::uint64_t along_y, std::uint64_t along_z,
                                std::array<std::uint64_t, 8>& words) {
  unsigned any = 0;
#if HWY_TARGET == HWY_SCALAR
  for (unsigned x = 0; x < 8; ++x) {
    words[x] = along_x & fill_rows(along_z >> (8 * x)) & (along_y >> (8 * x) & 0xff) * kFirstColumn;
    any |= unsigned{words[x] != 0} << x;
  }
#else
  constexpr hn::CappedTag<std::uint8_t, 64> kBytes{};
  constexpr hn::Repartition<std::uint64_t, decltype(kBytes)> kWords{};
  alignas(64) static constexpr std::array<std::uint8_t, 64> kWordOfByte = {
      0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 2, 2,
      2, 2, 3, 3, 3, 3, 3, 3, 3, 3, 4, 4, 4, 4, 4, 4, 4, 4, 5, 5, 5, 5,
      5, 5, 5, 5, 6, 6, 6, 6, 6, 6, 6, 6, 7, 7, 7, 7, 7, 7, 7, 7};
  const auto over_x = hn::Set(kWords, along_x);
  const auto over_y = hn::BitCast(kBytes, hn::Set(kWords, along_y));
  for (std::size_t first = 0; first < 64; first += hn::Lanes(kBytes)) {
    // Byte 8 x + y of a vector is row y of word x.
    const std::uint64_t some_rows = along_z >> first;
    const auto rows = hn::VecFromMask(
        kBytes, hn::LoadMaskBits(kBytes, reinterpret_cast<const std::uint8_t*>(&some_rows)));
    const auto columns = hn::TableLookupBytes(over_y, hn::Load(kBytes, kWordOfByte.data() + first));
    const auto cells = hn::And(over_x, hn::BitCast(kWords, hn::And(rows, columns)));
    hn::StoreU(cells, kWords, words.data() + first / 8);
    std::uint8_t part = 0;
    hn::StoreMaskBits(kWords, hn::Ne(cells, hn::Zero(kWords)), &part);
    any |= unsigned{part} << first / 8;
  }
#endif
  return any;
}

}  // namespace
}  // namespace forcelayer::scan::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif

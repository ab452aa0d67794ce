// Moves the lanes of a mask together. Included once per instruction set, behind Highway, by the
// kernels that are compiled for each.
#if defined(FORCELAYER_PACKING_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FORCELAYER_PACKING_INL_H
#undef FORCELAYER_PACKING_INL_H
#else
#define FORCELAYER_PACKING_INL_H
#endif

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace forcelayer {
namespace HWY_NAMESPACE {
namespace {

// D is a tag of floats. Highway's own Compress copies its tables to the stack on every call where
// there is no instruction for it, which takes longer than all the rest of a query.
#if HWY_TARGET <= HWY_AVX3
template <class D>
class Packing {
 public:
  explicit HWY_INLINE Packing(hwy::HWY_NAMESPACE::Mask<D> kept) : kept_(kept) {}
  template <class V>
  HWY_INLINE V operator()(V v) const {
    namespace hn = hwy::HWY_NAMESPACE;
    return hn::Compress(v, hn::RebindMask(hn::DFromV<V>(), kept_));
  }
  HWY_INLINE std::size_t count() const { return hwy::HWY_NAMESPACE::CountTrue(D(), kept_); }

 private:
  hwy::HWY_NAMESPACE::Mask<D> kept_;
};
#else
// Per bit pattern of a mask the numbers of its set bits, then zeros.
template <std::size_t kLaneCount>
inline constexpr auto kSetBits = [] {
  std::array<std::array<std::uint8_t, 8>, std::size_t{1} << kLaneCount> table{};
  for (std::size_t bits = 0; bits < table.size(); ++bits) {
    std::size_t count = 0;
    for (std::uint8_t bit = 0; bit < kLaneCount; ++bit) {
      if (bits >> bit & 1) table[bits][count++] = bit;
    }
  }
  return table;
}();

template <class D>
class Packing {
  using Ints = hwy::HWY_NAMESPACE::RebindToSigned<D>;

 public:
  explicit HWY_INLINE Packing(hwy::HWY_NAMESPACE::Mask<D> kept) {
    namespace hn = hwy::HWY_NAMESPACE;
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(D(), kept, bits);
    count_ = hn::CountTrue(D(), kept);
    const hn::Rebind<std::uint8_t, Ints> d8;
    from_ = hn::PromoteTo(Ints(), hn::LoadU(d8, kSetBits<hn::MaxLanes(D())>[bits[0]].data()));
  }
  template <class V>
  HWY_INLINE V operator()(V v) const {
    namespace hn = hwy::HWY_NAMESPACE;
    return hn::TableLookupLanes(v, hn::IndicesFromVec(hn::DFromV<V>(), from_));
  }
  HWY_INLINE std::size_t count() const { return count_; }

 private:
  hwy::HWY_NAMESPACE::Vec<Ints> from_;
  std::size_t count_;
};
#endif

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer
HWY_AFTER_NAMESPACE();

#endif  // once per instruction set

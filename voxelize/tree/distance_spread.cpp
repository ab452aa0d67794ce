#include "voxelize/tree/distance_spread.h"

// Compiled once for every instruction set that Highway supports, picked at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/tree/distance_spread.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include <utility>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// A plane of a field, each cell the least of its 3x3 neighbourhood in the plane. Cells on the
// plane's border may take a cell for a neighbour that is none.
template <class T>
class PlaneLeast {
 public:
  static constexpr hn::CappedTag<T, 64> kTag{};
  using Field = DistanceField<T>;

  HWY_INLINE void set(const T* cells, int width) {
    least_of_three(cells, 1, width * width, along_z_ + Field::kPadding);
    least_of_three(along_z_ + Field::kPadding, width, width * width, least_);
  }
  HWY_INLINE auto at(int i) const { return hn::LoadU(kTag, least_ + i); }

 private:
  static HWY_INLINE void least_of_three(const T* from, int step, int count, T* to) {
    for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(kTag))) {
      const auto sides =
          hn::Min(hn::LoadU(kTag, from + i - step), hn::LoadU(kTag, from + i + step));
      hn::StoreU(hn::Min(hn::LoadU(kTag, from + i), sides), kTag, to + i);
    }
  }

  T along_z_[Field::kMaxPlane + 2 * Field::kPadding] = {};
  T least_[Field::kMaxPlane];
};

// One step from every cell of the planes first..last to its neighbours.
template <class T>
HWY_INLINE void step(DistanceField<T>& field, int first, int last, T edge,
                     PlaneLeast<T> (&planes)[3]) {
  constexpr auto kTag = PlaneLeast<T>::kTag;
  const int width = field.width();
  PlaneLeast<T>*below = &planes[0], *here = &planes[1], *above = &planes[2];
  below->set(field.plane(first - 1), width);
  here->set(field.plane(first), width);
  const auto edges = hn::Set(kTag, edge);
  for (int x = first; x <= last; ++x) {
    above->set(field.plane(x + 1), width);
    T* cells = field.plane(x);
    for (int i = 0; i < width * width; i += static_cast<int>(hn::Lanes(kTag))) {
      const auto least = hn::Min(here->at(i), hn::Min(below->at(i), above->at(i)));
      hn::StoreU(hn::Min(hn::LoadU(kTag, cells + i), hn::SaturatedAdd(least, edges)), kTag,
                 cells + i);
    }
    std::swap(below, here);
    std::swap(here, above);
  }
}

// Cells on the border of the cube miss neighbours or take wrong ones, and with every step what is
// wrong comes one layer further in: the middle stays right for as many steps as the margin is deep.
template <class T>
void spread(DistanceField<T>& field, T edge) {
  PlaneLeast<T> planes[3];
  for (int margin = field.margin() - 1; margin >= 0; --margin) {
    step(field, -margin, 7 + margin, edge, planes);
  }
}

void spread_bytes(DistanceField<std::uint8_t>& field, std::uint8_t edge) { spread(field, edge); }
void spread_words(DistanceField<std::uint16_t>& field, std::uint16_t edge) { spread(field, edge); }

}  // namespace
}  // namespace forcelayer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer {
namespace {
HWY_EXPORT(spread_bytes);
HWY_EXPORT(spread_words);
}  // namespace

template <>
void DistanceField<std::uint8_t>::spread(std::uint8_t edge) {
  HWY_DYNAMIC_DISPATCH(spread_bytes)(*this, edge);
}
template <>
void DistanceField<std::uint16_t>::spread(std::uint16_t edge) {
  HWY_DYNAMIC_DISPATCH(spread_words)(*this, edge);
}

}  // namespace forcelayer
#endif

#include "voxelize/tree/clearance_cube.h"

// Compiled once for every instruction set that Highway supports, picked at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/tree/clearance_cube.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include <utility>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::tree::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// A plane of a cube, each cell the minimum of its 3x3 neighborhood in the plane. Cells on the
// plane's border may take in cells that are no neighbors.
template <class T>
class PlaneMinimum {
 public:
  static constexpr hn::CappedTag<T, 64> kTag{};
  using Cube = ClearanceCube<T>;

  HWY_INLINE void set(const T* cells, int width) {
    min_of_three(cells, 1, width * width, along_z_ + Cube::kPadding);
    min_of_three(along_z_ + Cube::kPadding, width, width * width, min_);
  }
  HWY_INLINE auto at(int i) const { return hn::LoadU(kTag, min_ + i); }

 private:
  static HWY_INLINE void min_of_three(const T* from, int step, int count, T* to) {
    for (int i = 0; i < count; i += static_cast<int>(hn::Lanes(kTag))) {
      const auto sides =
          hn::Min(hn::LoadU(kTag, from + i - step), hn::LoadU(kTag, from + i + step));
      hn::StoreU(hn::Min(hn::LoadU(kTag, from + i), sides), kTag, to + i);
    }
  }

  T along_z_[Cube::kMaxPlane + 2 * Cube::kPadding] = {};
  T min_[Cube::kMaxPlane];
};

// One step from every cell of the planes first..last to its neighbors.
template <class T>
HWY_INLINE void step(ClearanceCube<T>& cube, int first, int last, T edge,
                     PlaneMinimum<T> (&planes)[3]) {
  constexpr auto kTag = PlaneMinimum<T>::kTag;
  const int width = cube.width();
  PlaneMinimum<T>*below = &planes[0], *here = &planes[1], *above = &planes[2];
  below->set(cube.plane(first - 1), width);
  here->set(cube.plane(first), width);
  const auto edges = hn::Set(kTag, edge);
  for (int x = first; x <= last; ++x) {
    above->set(cube.plane(x + 1), width);
    T* cells = cube.plane(x);
    for (int i = 0; i < width * width; i += static_cast<int>(hn::Lanes(kTag))) {
      const auto smallest = hn::Min(here->at(i), hn::Min(below->at(i), above->at(i)));
      hn::StoreU(hn::Min(hn::LoadU(kTag, cells + i), hn::SaturatedAdd(smallest, edges)), kTag,
                 cells + i);
    }
    std::swap(below, here);
    std::swap(here, above);
  }
}

// Cells on the border of the cube take in wrong neighbors. With every step the error moves one
// layer inwards, so the middle stays right for as many steps as the margin is deep.
template <class T>
void spread(ClearanceCube<T>& cube, T edge) {
  PlaneMinimum<T> planes[3];
  for (int margin = cube.margin() - 1; margin >= 0; --margin) {
    step(cube, -margin, 7 + margin, edge, planes);
  }
}

void spread_bytes(ClearanceCube<std::uint8_t>& cube, std::uint8_t edge) { spread(cube, edge); }
void spread_words(ClearanceCube<std::uint16_t>& cube, std::uint16_t edge) { spread(cube, edge); }

}  // namespace
}  // namespace forcelayer::tree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::tree {
namespace {
HWY_EXPORT(spread_bytes);
HWY_EXPORT(spread_words);
}  // namespace

template <>
void ClearanceCube<std::uint8_t>::spread(std::uint8_t edge) {
  HWY_DYNAMIC_DISPATCH(spread_bytes)(*this, edge);
}
template <>
void ClearanceCube<std::uint16_t>::spread(std::uint16_t edge) {
  HWY_DYNAMIC_DISPATCH(spread_words)(*this, edge);
}

}  // namespace forcelayer::tree
#endif

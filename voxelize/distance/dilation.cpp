#include "voxelize/distance/dilation.h"

// Compiled once for every instruction set that Highway supports, picked at run time.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "voxelize/distance/dilation.cpp"
#include <hwy/foreach_target.h>
// After foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::distance::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr int kEdge = 64;  // voxels of a node
constexpr int kRadii = 3;
constexpr hn::CappedTag<std::uint64_t, 8> kTag{};
using V = hn::Vec<decltype(kTag)>;

HWY_INLINE int lanes() { return static_cast<int>(hn::Lanes(kTag)); }
HWY_INLINE V load(const std::uint64_t* from) { return hn::LoadU(kTag, from); }

// Rows moved by `step` voxels (1..63) both ways.
HWY_INLINE V stepped(V below, V here, V above, int step) {
  return hn::Or(hn::Or(hn::ShiftLeftSame(here, step), hn::ShiftRightSame(below, kEdge - step)),
                hn::Or(hn::ShiftRightSame(here, step), hn::ShiftLeftSame(above, kEdge - step)));
}

// One plane dilated along z by the three radii: [radius][row].
HWY_INLINE void dilate_along_z(const NodeHalo& halo, int plane, std::uint64_t* out) {
  const int stride = halo.stride();
  for (int y = 0; y < halo.width(); y += lanes()) {
    const V below = load(halo.rows(plane, 0) + y), here = load(halo.rows(plane, 1) + y),
            above = load(halo.rows(plane, 2) + y);
    V row = hn::Zero(kTag);
    int reached = -1;
    for (int r = 0; r < kRadii; ++r) {
      for (; reached < halo.radius(r); ++reached) {
        row = hn::Or(row, reached < 0 ? here : stepped(below, here, above, reached + 1));
      }
      hn::StoreU(row, kTag, out + r * stride + y);
    }
  }
}

// That plane dilated along y: [radius][64 rows of the node].
HWY_INLINE void dilate_along_y(const NodeHalo& halo, const std::uint64_t* along_z,
                               std::uint64_t* out) {
  for (int r = 0; r < kRadii; ++r) {
    const int radius = halo.radius(r);
    const std::uint64_t* from = along_z + r * halo.stride() + halo.halo();
    for (int y = 0; y < kEdge; y += lanes()) {
      V row = hn::Zero(kTag);
      for (int dy = -radius; dy <= radius; ++dy) row = hn::Or(row, load(from + y + dy));
      hn::StoreU(row, kTag, out + r * kEdge + y);
    }
  }
}

// Dilation along x and the voxels' values, for one plane of the node.
class PlaneClassifier {
 public:
  HWY_INLINE PlaneClassifier(const NodeHalo& halo, const std::uint64_t* dilated)
      : halo_(halo), dilated_(dilated) {}

  HWY_INLINE void run(int x, std::uint64_t* low, std::uint64_t* high) {
    for (int y = 0; y < kEdge; y += lanes()) {
      V within[kRadii] = {hn::Zero(kTag), hn::Zero(kTag), hn::Zero(kTag)};
      gather(x, y, within);
      const V solid = load(low + y);
      const V interior = hn::Or(solid, within[0]);
      const V surface = hn::AndNot(interior, within[1]);
      const V proximity = hn::AndNot(hn::Or(within[1], solid), within[2]);
      hn::StoreU(hn::Or(interior, proximity), kTag, low + y);
      hn::StoreU(hn::Or(surface, proximity), kTag, high + y);
      interior_ = hn::Add(interior_, hn::PopulationCount(interior));
      surface_ = hn::Add(surface_, hn::PopulationCount(surface));
      proximity_ = hn::Add(proximity_, hn::PopulationCount(proximity));
    }
  }

  HWY_INLINE ValueCounts counts() const { return {sum(interior_), sum(surface_), sum(proximity_)}; }

 private:
  HWY_INLINE void gather(int x, int y, V (&within)[kRadii]) const {
    const int reach = halo_.halo();
    for (int dx = -reach; dx <= reach; ++dx) {
      const int plane = x + reach + dx;
      if (!halo_.occupied(plane)) continue;
      const std::uint64_t* rows = dilated_ + plane * kRadii * kEdge + y;
      within[2] = hn::Or(within[2], load(rows + 2 * kEdge));
      if (std::abs(dx) <= halo_.radius(1)) within[1] = hn::Or(within[1], load(rows + kEdge));
      if (std::abs(dx) <= halo_.radius(0)) within[0] = hn::Or(within[0], load(rows));
    }
  }

  static HWY_INLINE std::uint64_t sum(V counts) {
    return hn::GetLane(hn::SumOfLanes(kTag, counts));
  }

  const NodeHalo& halo_;
  const std::uint64_t* dilated_;
  V interior_ = hn::Zero(kTag), surface_ = hn::Zero(kTag), proximity_ = hn::Zero(kTag);
};

ValueCounts offset(const NodeHalo& halo, std::uint64_t* dilated, NodeCodes& codes) {
  constexpr int kMaxStride = kEdge + 2 * NodeHalo::kMaxHalo + 16;
  alignas(64) std::uint64_t along_z[kRadii * kMaxStride];
  for (int plane = 0; plane < halo.width(); ++plane) {
    if (!halo.occupied(plane)) continue;
    dilate_along_z(halo, plane, along_z);
    dilate_along_y(halo, along_z, dilated + plane * kRadii * kEdge);
  }
  PlaneClassifier classifier(halo, dilated);
  for (int x = 0; x < kEdge; ++x) {
    classifier.run(x, codes.low.data() + x * kEdge, codes.high.data() + x * kEdge);
  }
  return classifier.counts();
}

}  // namespace
}  // namespace forcelayer::distance::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::distance {
namespace {
HWY_EXPORT(offset);
}  // namespace

void NodeHalo::begin(int layers, int force_layers) {
  halo_ = layers + force_layers;
  force_layers_ = force_layers;
  width_ = 64 + 2 * halo_;
  planes_ = 0;
  occupied_.assign(static_cast<std::size_t>(width_), 0);
  rows_.resize(static_cast<std::size_t>(width_ * 3 * stride()));
  dilated_.resize(static_cast<std::size_t>(width_ * 3 * 64));
}

std::uint64_t* NodeHalo::rows(int plane, int word) {
  std::uint8_t& occupied = occupied_[static_cast<std::size_t>(plane)];
  std::uint64_t* first = rows_.data() + static_cast<std::size_t>(plane * 3 * stride());
  if (occupied == 0) {
    std::fill_n(first, 3 * stride(), 0);
    occupied = 1;
    ++planes_;
  }
  return first + word * stride();
}

ValueCounts offset_node(NodeHalo& halo, NodeCodes& codes) {
  return HWY_DYNAMIC_DISPATCH(offset)(halo, halo.dilated_.data(), codes);
}

}  // namespace forcelayer::distance
#endif

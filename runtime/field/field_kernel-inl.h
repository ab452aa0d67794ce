// What the vector kernels of the force fields share: picking points out of those collected, finding
// their decoded bricks and storing samples. Included once per instruction set, behind Highway, by
// the files that are compiled for each (level_push.cpp, distance_push.cpp).
#if defined(FORCELAYER_FIELD_KERNEL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FORCELAYER_FIELD_KERNEL_INL_H
#undef FORCELAYER_FIELD_KERNEL_INL_H
#else
#define FORCELAYER_FIELD_KERNEL_INL_H
#endif

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <type_traits>

#include "runtime/field/brick_memo.h"
#include "runtime/field/force_field.h"
#include "runtime/query/contact_query.h"
#include "runtime/query/packing-inl.h"

HWY_BEFORE_NAMESPACE();
namespace forcelayer {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using VF = hn::Vec<Floats>;
using VI = hn::Vec<Ints>;
constexpr Floats kF;
constexpr Ints kI;
constexpr std::size_t kLanes = HWY_LANES(float);

HWY_INLINE VF dot(const VF (&a)[3], const VF (&b)[3]) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}

HWY_INLINE VF clamp01(VF x) { return hn::Min(hn::Max(x, hn::Zero(kF)), hn::Set(kF, 1.0f)); }

// Leaves the lanes of a mask, the first so many, where they are.
class Unmoved {
 public:
  explicit HWY_INLINE Unmoved(hn::Mask<Floats> kept) : count_(hn::CountTrue(kF, kept)) {}
  template <class V>
  HWY_INLINE V operator()(V v) const {
    return v;
  }
  HWY_INLINE std::size_t count() const { return count_; }

 private:
  std::size_t count_;
};

// A vector of points on their way through the kernel.
struct Lanes {
  VI at;  // index into CollectedPoints
  VI voxel[3];
  VF fraction[3], normal[3];
  hn::Mask<Ints> wanted;
};

// Points go through the kernel in chunks, stage by stage: one vector's way is long, and processors
// look ahead far enough to overlap several vectors only where each stage is short.
constexpr std::size_t kChunk = 256;

constexpr auto kNumbers = [] {
  std::array<std::int32_t, kLanes> numbers{};
  for (std::size_t i = 0; i < kLanes; ++i) numbers[i] = static_cast<std::int32_t>(i);
  return numbers;
}();

// Points that were picked out, until they fill vectors.
struct Picked {
  static constexpr std::size_t kRoom = kChunk + kLanes;

  HWY_ALIGN std::int32_t at[kRoom];
  HWY_ALIGN std::int32_t voxel[3][kRoom];
  HWY_ALIGN float fraction[3][kRoom];
  HWY_ALIGN float normal[3][kRoom];
  std::size_t count = 0;

  // So many were picked. The lanes behind the last, which are read along with it, must hold
  // numbers.
  HWY_INLINE void close(std::size_t end) {
    count = end;
    hn::StoreU(hn::Zero(kI), kI, at + end);
    for (int axis = 0; axis < 3; ++axis) {
      hn::StoreU(hn::Zero(kI), kI, voxel[axis] + end);
      hn::StoreU(hn::Zero(kF), kF, fraction[axis] + end);
      hn::StoreU(hn::Zero(kF), kF, normal[axis] + end);
    }
  }
};

// Samples the points that may have depth, or all points (ForceField::measure), with what `Bricks`,
// a BrickMemo, holds. Of points that were picked out the lanes have their normals only where
// Derived::kPicksNormals says so.
template <class Derived, class Bricks, bool kAllPoints>
class FieldKernel {
 public:
  // Hands the wanted points on to Derived::push_chunk(count, load): the first `count` that load(i),
  // load(i + kLanes), ... give. Picking the points out first is worth its while only where many are
  // not wanted.
  HWY_INLINE void run() {
    samples_.count = 0;
    const std::uint32_t band = outermost_ == VoxelValue::kProximity
                                   ? points_.count
                                   : points_.surface_count + points_.interior_count;
    if (kAllPoints || band >= points_.count - points_.count / 4) {
      for (std::uint32_t first = 0; first < points_.count; first += kChunk) {
        const auto from = [&](std::size_t i) HWY_ATTR {
          const auto at = static_cast<std::uint32_t>(first + i);
          return load(at, wanted_of(at));
        };
        derived().push_chunk(std::min<std::size_t>(kChunk, points_.count - first), from);
      }
      return;
    }
    Picked picked;
    for (std::uint32_t first = 0; first < points_.count;) {
      std::size_t count = 0;  // not a member, which every store would write back
      for (; first < points_.count && count + kLanes <= kChunk; first += kLanes) {
        count += pick(first, picked, count);
      }
      picked.close(count);
      derived().push_chunk(picked.count, [&](std::size_t i) HWY_ATTR { return load(picked, i); });
    }
  }

 protected:
  // `outermost`: the value, 2 or 3, out to which points may have depth.
  FieldKernel(const CollectedPoints& points, Bricks& bricks, FieldSamples& samples,
              VoxelValue outermost = VoxelValue::kSurface)
      : points_(points), bricks_(bricks), samples_(samples), outermost_(outermost) {}

  // Appends the samples of a mask.
  HWY_INLINE void store(hn::Mask<Floats> kept, VI at, VF depth_m, const VF (&direction)[3],
                        const VF (&slope)[3]) {
    const std::conditional_t<kAllPoints, Unmoved, Packing<Floats>> pack(kept);
    const std::uint32_t to = samples_.count;
    const hn::RebindToUnsigned<Ints> u32;
    hn::StoreU(hn::BitCast(u32, pack(at)), u32, &samples_.at[to]);
    hn::StoreU(pack(depth_m), kF, &samples_.depth_m[to]);
    hn::StoreU(pack(direction[0]), kF, &samples_.dx[to]);
    hn::StoreU(pack(direction[1]), kF, &samples_.dy[to]);
    hn::StoreU(pack(direction[2]), kF, &samples_.dz[to]);
    if (kAllPoints) {
      hn::StoreU(pack(slope[0]), kF, &samples_.gx[to]);
      hn::StoreU(pack(slope[1]), kF, &samples_.gy[to]);
      hn::StoreU(pack(slope[2]), kF, &samples_.gz[to]);
    }
    samples_.count += static_cast<std::uint32_t>(pack.count());
  }

  // Where the bricks of voxels stand, and whether they are there.
  struct Found {
    VI slot;
    hn::Mask<Ints> held;
  };
  HWY_INLINE Found find(const VI (&voxel)[3]) const {
    const VI key = key_of(voxel);
    Found found;
    found.slot = slot_of(key);
    const auto* keys = reinterpret_cast<const std::int32_t*>(bricks_.keys());
    found.held = hn::Eq(hn::GatherIndex(kI, keys, found.slot), key);
    if (HWY_UNLIKELY(!bricks_.keys_are_unique())) {
      found.held = hn::And(found.held, tags_match(found.slot, voxel));
    }
    return found;
  }

  // The keys of voxels' bricks, and where those stand if they are there.
  HWY_INLINE VI key_of(const VI (&voxel)[3]) const {
    const auto& strides = bricks_.strides();
    VI brick[3];
    for (int axis = 0; axis < 3; ++axis) brick[axis] = hn::ShiftRight<3>(voxel[axis]);
    return hn::Add(
        hn::Add(hn::Mul(brick[0], constant(strides[0])), hn::Mul(brick[1], constant(strides[1]))),
        brick[2]);
  }
  static HWY_INLINE VI slot_of(VI key) {
    const hn::RebindToUnsigned<Ints> u32;
    return hn::BitCast(kI, hn::ShiftRight<32 - BrickMemo::kSlotBits>(
                               hn::BitCast(u32, hn::Mul(key, constant(BrickMemo::kHash)))));
  }

  // Whether the bricks in these slots are those of voxels, not only of the same key.
  HWY_INLINE hn::Mask<Ints> tags_match(VI slot, const VI (&voxel)[3]) const {
    const VI at = hn::ShiftLeft<2>(slot);
    auto match = hn::FirstN(kI, kLanes);
    for (int axis = 0; axis < 3; ++axis) {
      const VI tag = hn::GatherIndex(kI, bricks_.tags() + axis, at);
      match = hn::And(match, hn::Eq(tag, hn::ShiftRight<3>(voxel[axis])));
    }
    return match;
  }

  // Decodes the bricks of voxels that were not held, and calls take(lane, bytes) with what stands
  // `offset` bytes into a lane's: one brick may replace another, so it is to be used at once.
  template <class Take>
  HWY_NOINLINE void fetch(const VI (&voxel)[3], VI offset, hn::Mask<Ints> missing,
                          const Take& take) {
    HWY_ALIGN std::int32_t at[3][kLanes];
    HWY_ALIGN std::int32_t offsets[kLanes];
    HWY_ALIGN std::int32_t wanted[kLanes];
    for (int axis = 0; axis < 3; ++axis) hn::Store(voxel[axis], kI, at[axis]);
    hn::Store(offset, kI, offsets);
    hn::Store(hn::VecFromMask(kI, missing), kI, wanted);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (wanted[lane] == 0) continue;
      const std::uint8_t* brick =
          bricks_.hold(at[0][lane] >> 3, at[1][lane] >> 3, at[2][lane] >> 3);
      take(lane, brick + offsets[lane]);
    }
  }

  static HWY_INLINE VI constant(std::uint32_t value) {
    return hn::Set(kI, static_cast<std::int32_t>(value));
  }

  const CollectedPoints& points_;
  Bricks& bricks_;
  FieldSamples& samples_;

 private:
  Derived& derived() { return static_cast<Derived&>(*this); }

  HWY_INLINE hn::Mask<Ints> wanted_of(std::uint32_t first) const {
    const auto real = hn::FirstN(kI, points_.count - first);
    if (kAllPoints) return real;
    const hn::Rebind<std::uint8_t, Ints> d8;
    const VI value = hn::PromoteTo(kI, hn::LoadU(d8, &points_.value[first]));
    return hn::And(real, hn::Lt(value, hn::Set(kI, static_cast<int>(outermost_) + 1)));
  }

  HWY_INLINE Lanes load(std::uint32_t first, hn::Mask<Ints> wanted) const {
    Lanes lanes;
    // Highway's own Iota is written to memory number by number.
    lanes.at =
        hn::Add(hn::Set(kI, static_cast<std::int32_t>(first)), hn::LoadU(kI, kNumbers.data()));
    const std::int32_t* voxel[3] = {points_.vx.data(), points_.vy.data(), points_.vz.data()};
    const float* fraction[3] = {points_.fx.data(), points_.fy.data(), points_.fz.data()};
    const float* normal[3] = {points_.nx.data(), points_.ny.data(), points_.nz.data()};
    for (int axis = 0; axis < 3; ++axis) {
      lanes.voxel[axis] = hn::LoadU(kI, voxel[axis] + first);
      lanes.fraction[axis] = hn::LoadU(kF, fraction[axis] + first);
      lanes.normal[axis] = hn::LoadU(kF, normal[axis] + first);
    }
    lanes.wanted = wanted;
    return lanes;
  }

  static HWY_INLINE Lanes load(const Picked& picked, std::size_t i) {
    Lanes lanes;
    lanes.at = hn::Load(kI, picked.at + i);
    for (int axis = 0; axis < 3; ++axis) {
      lanes.voxel[axis] = hn::Load(kI, picked.voxel[axis] + i);
      lanes.fraction[axis] = hn::Load(kF, picked.fraction[axis] + i);
      if (Derived::kPicksNormals) lanes.normal[axis] = hn::Load(kF, picked.normal[axis] + i);
    }
    lanes.wanted = hn::FirstN(kI, picked.count - i);
    return lanes;
  }

  // Puts the next lanes' wanted points behind the first `to`; their number.
  HWY_INLINE std::size_t pick(std::uint32_t first, Picked& picked, std::size_t to) const {
    const auto wanted = wanted_of(first);
    if (hn::AllFalse(kI, wanted)) return 0;
    const Packing<Floats> pack(hn::RebindMask(kF, wanted));
    const Lanes lanes = load(first, wanted);
    hn::StoreU(pack(lanes.at), kI, picked.at + to);
    for (int axis = 0; axis < 3; ++axis) {
      hn::StoreU(pack(lanes.voxel[axis]), kI, picked.voxel[axis] + to);
      hn::StoreU(pack(lanes.fraction[axis]), kF, picked.fraction[axis] + to);
      if (Derived::kPicksNormals) {
        hn::StoreU(pack(lanes.normal[axis]), kF, picked.normal[axis] + to);
      }
    }
    return pack.count();
  }

  VoxelValue outermost_;
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer
HWY_AFTER_NAMESPACE();

#endif  // once per instruction set

// Shared by the vector kernels of the force fields: loading points, finding their decoded bricks
// and storing samples. Included once per instruction set, behind Highway, by the files that are
// compiled for each (level_field_kernel.cpp, distance_field_kernel.cpp).
#if defined(FORCELAYER_FIELD_KERNEL_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef FORCELAYER_FIELD_KERNEL_INL_H
#undef FORCELAYER_FIELD_KERNEL_INL_H
#else
#define FORCELAYER_FIELD_KERNEL_INL_H
#endif

#include <hwy/highway.h>

#include "runtime/field/brick_cache.h"
#include "runtime/field/force_field.h"
#include "runtime/query/contact_query.h"

HWY_BEFORE_NAMESPACE();
namespace forcelayer::field {
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

// A vector of collected points.
struct Lanes {
  VI voxel[3];
  VF fraction[3], normal[3];
  hn::Mask<Ints> real;  // lanes before the list's end
};

// Points go through the kernel in chunks, stage by stage: one vector's way is long, and processors
// look ahead far enough to overlap several vectors only where each stage is short.
constexpr std::size_t kChunk = 256;

// Bricks is the BrickCache that holds what the field reads.
template <class Bricks>
class FieldKernel {
 protected:
  FieldKernel(const query::CollectedPoints& points, Bricks& bricks, FieldSamples& samples)
      : points_(points), bricks_(bricks), samples_(samples) {}

  // The points from `first` on.
  HWY_INLINE Lanes load(std::size_t first) const {
    Lanes lanes;
    const std::int32_t* voxel[3] = {points_.vx.data(), points_.vy.data(), points_.vz.data()};
    const float* fraction[3] = {points_.fx.data(), points_.fy.data(), points_.fz.data()};
    const float* normal[3] = {points_.nx.data(), points_.ny.data(), points_.nz.data()};
    for (int axis = 0; axis < 3; ++axis) {
      lanes.voxel[axis] = hn::LoadU(kI, voxel[axis] + first);
      lanes.fraction[axis] = hn::LoadU(kF, fraction[axis] + first);
      lanes.normal[axis] = hn::LoadU(kF, normal[axis] + first);
    }
    lanes.real = hn::FirstN(kI, points_.count - first);
    return lanes;
  }

  // The samples of the points from `first` on.
  HWY_INLINE void store(std::size_t first, VF depth_m, const VF (&direction)[3],
                        const VF (&slope)[3]) {
    hn::StoreU(depth_m, kF, &samples_.depth_m[first]);
    hn::StoreU(direction[0], kF, &samples_.dx[first]);
    hn::StoreU(direction[1], kF, &samples_.dy[first]);
    hn::StoreU(direction[2], kF, &samples_.dz[first]);
    hn::StoreU(slope[0], kF, &samples_.gx[first]);
    hn::StoreU(slope[1], kF, &samples_.gy[first]);
    hn::StoreU(slope[2], kF, &samples_.gz[first]);
  }

  // The slots of the bricks of voxels, and whether the bricks are there.
  struct BrickSlots {
    VI slot;
    hn::Mask<Ints> held;
  };
  HWY_INLINE BrickSlots find_bricks(const VI (&voxel)[3]) const {
    const VI key = key_of(voxel);
    BrickSlots found;
    found.slot = slot_of(key);
    const auto* keys = reinterpret_cast<const std::int32_t*>(bricks_.keys());
    found.held = hn::Eq(hn::GatherIndex(kI, keys, found.slot), key);
    if (HWY_UNLIKELY(!bricks_.keys_are_unique())) {
      found.held = hn::And(found.held, tags_match(found.slot, voxel));
    }
    return found;
  }

  // The keys of voxels' bricks, and the slots of keys.
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
    return hn::BitCast(kI, hn::ShiftRight<32 - BrickCache::kSlotBits>(
                               hn::BitCast(u32, hn::Mul(key, constant(BrickCache::kHash)))));
  }

  // Whether the bricks in these slots are the voxels' own and not others of the same key.
  HWY_INLINE hn::Mask<Ints> tags_match(VI slot, const VI (&voxel)[3]) const {
    const VI at = hn::ShiftLeft<2>(slot);
    auto match = hn::FirstN(kI, kLanes);
    for (int axis = 0; axis < 3; ++axis) {
      const VI tag = hn::GatherIndex(kI, bricks_.tags() + axis, at);
      match = hn::And(match, hn::Eq(tag, hn::ShiftRight<3>(voxel[axis])));
    }
    return match;
  }

  // Decodes the bricks of the lanes in `missing` and calls take(lane, address) for each, the
  // address being `offset` bytes into the decoded brick. take() must read at once: the next brick
  // may replace this one.
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
          bricks_.hold_brick(at[0][lane] >> 3, at[1][lane] >> 3, at[2][lane] >> 3);
      take(lane, brick + offsets[lane]);
    }
  }

  static HWY_INLINE VI constant(std::uint32_t value) {
    return hn::Set(kI, static_cast<std::int32_t>(value));
  }

  const query::CollectedPoints& points_;
  Bricks& bricks_;
  FieldSamples& samples_;
};

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer::field
HWY_AFTER_NAMESPACE();

#endif  // once per instruction set

#include "runtime/level_push.h"

#include <array>

// Vectors stand in arrays here, which those of unknown size cannot.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/level_push.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

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

// `value` in each of the four bytes of a lane. Bytes never leave [0, 255], so that sums and
// differences of lanes are those of their bytes; differences are raised to stay positive.
HWY_INLINE VI in_bytes(int value) { return hn::Set(kI, value * 0x01010101); }
HWY_INLINE VI raised_difference(VI a, VI b, int raise) {
  return hn::Sub(hn::Add(a, in_bytes(raise)), b);
}
// Byte n+1 of each lane in the place of byte n.
HWY_INLINE VI next_byte(VI a) { return hn::ShiftRight<8>(a); }

HWY_INLINE VF mix(VF a, VF b, VF share) { return hn::Add(a, hn::Mul(share, hn::Sub(b, a))); }

HWY_INLINE VF dot(const VF (&a)[3], const VF (&b)[3]) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}

HWY_INLINE VF clamp01(VF x) { return hn::Min(hn::Max(x, hn::Zero(kF)), hn::Set(kF, 1.0f)); }

// Sums over the eight voxels around the corners at one x and y of a voxel, raised by `raise`; those
// at z and z+1 are bytes 0 and 1 of each lane.
struct Corners {
  VI sums[4];  // [2 x + y]
  int raise;
};

// A byte, which is b, as the float 2^23 + b: exact, and cheaper than a conversion.
constexpr std::int32_t kTwoTo23 = 0x4b000000;
HWY_INLINE VF byte_over_two_to_23(VI lanes) {
  return hn::BitCast(kF, hn::OrAnd(hn::Set(kI, kTwoTo23), lanes, hn::Set(kI, 0xff)));
}

HWY_INLINE VF mix_z(VI sums, int raise, VF share) {
  const VF low = byte_over_two_to_23(sums), high = byte_over_two_to_23(next_byte(sums));
  const VF base = hn::Set(kF, 8388608.0f + static_cast<float>(raise));
  return hn::Add(hn::Sub(low, base), hn::Mul(share, hn::Sub(high, low)));
}

HWY_INLINE VF between_corners(const Corners& corners, const VF (&fraction)[3]) {
  VF at[4];
  for (int i = 0; i < 4; ++i) at[i] = mix_z(corners.sums[i], corners.raise, fraction[2]);
  return mix(mix(at[0], at[1], fraction[1]), mix(at[2], at[3], fraction[1]), fraction[0]);
}

// Raised levels around `kLanes` points: lanes of words[x] hold those at z-1, z, z+1 in bytes 0 to 2
// and, within a byte, those at y-1, y, y+1 in bits 0, 2 and 4.
struct Planes {
  VI words[3];
};

// phi (voxels) and its slope (per voxel).
HWY_INLINE void sample(const Planes& planes, const VF (&fraction)[3], VF& phi, VF (&slope)[3]) {
  VI sum_y[3][2], step_y[3][2];  // over and across the two rows at each corner's y
  for (int x = 0; x < 3; ++x) {
    const VI all = planes.words[x], level = in_bytes(3);
    const VI rows[3] = {hn::And(all, level), hn::And(hn::ShiftRight<2>(all), level),
                        hn::And(hn::ShiftRight<4>(all), level)};
    for (int y = 0; y < 2; ++y) {
      sum_y[x][y] = hn::Add(rows[y], rows[y + 1]);
      step_y[x][y] = raised_difference(rows[y + 1], rows[y], 4);
    }
  }
  Corners level{{}, 8}, along_x{{}, 16}, along_y{{}, 16}, along_z{{}, 16};
  for (int x = 0; x < 2; ++x) {
    for (int y = 0; y < 2; ++y) {
      const VI column = hn::Add(sum_y[x][y], sum_y[x + 1][y]);
      const VI across_x = raised_difference(sum_y[x + 1][y], sum_y[x][y], 8);
      const VI across_y = hn::Add(step_y[x][y], step_y[x + 1][y]);
      level.sums[2 * x + y] = hn::Add(column, next_byte(column));
      along_x.sums[2 * x + y] = hn::Add(across_x, next_byte(across_x));
      along_y.sums[2 * x + y] = hn::Add(across_y, next_byte(across_y));
      along_z.sums[2 * x + y] = raised_difference(next_byte(column), column, 16);
    }
  }
  const VF quarter = hn::Set(kF, 0.25f);
  phi = hn::Mul(between_corners(level, fraction), hn::Set(kF, 0.125f));
  slope[0] = hn::Mul(between_corners(along_x, fraction), quarter);
  slope[1] = hn::Mul(between_corners(along_y, fraction), quarter);
  slope[2] = hn::Mul(between_corners(along_z, fraction), quarter);
}

// The vector u of level_field.h.
HWY_INLINE void push(VF phi, const VF (&g)[3], const VF (&n)[3], VF (&u)[3]) {
  const VF one = hn::Set(kF, 1.0f);
  const VF along = dot(g, n);
  const VF agreement =
      hn::Sub(hn::Mul(along, hn::Abs(along)), hn::Mul(hn::Set(kF, kDisagreeing), dot(g, g)));
  const VF t = clamp01(hn::Mul(hn::Set(kF, kAgreementGain), agreement));
  const VF w = hn::Mul(hn::Mul(t, t), hn::Sub(hn::Set(kF, 3.0f), hn::Add(t, t)));
  const VF h = clamp01(hn::Mul(hn::Sub(hn::Set(kF, kBuried), phi), hn::Set(kF, 4.0f)));
  const VF along_normal = hn::Add(w, hn::Mul(hn::Set(kF, kBuriedNormal), h));
  const VF along_slope = hn::Sub(one, w);
  for (int axis = 0; axis < 3; ++axis) {
    u[axis] = hn::Add(hn::Mul(along_normal, n[axis]), hn::Mul(along_slope, g[axis]));
  }
}

// Moves the lanes of a mask together. Highway's own Compress copies its tables to the stack on
// every call where there is no instruction for it.
#if HWY_TARGET <= HWY_AVX3
class Packing {
 public:
  explicit HWY_INLINE Packing(hn::Mask<Floats> kept) : kept_(kept) {}
  HWY_INLINE VF operator()(VF v) const { return hn::Compress(v, kept_); }
  HWY_INLINE VI operator()(VI v) const { return hn::Compress(v, hn::RebindMask(kI, kept_)); }
  HWY_INLINE std::size_t count() const { return hn::CountTrue(kF, kept_); }

 private:
  hn::Mask<Floats> kept_;
};
#else
// Per bit pattern of a mask the numbers of its set bits, then zeros.
constexpr auto kSetBits = [] {
  std::array<std::array<std::uint8_t, 8>, 256> table{};
  for (std::size_t bits = 0; bits < 256; ++bits) {
    std::size_t count = 0;
    for (std::uint8_t bit = 0; bit < 8; ++bit) {
      if (bits >> bit & 1) table[bits][count++] = bit;
    }
  }
  return table;
}();

class Packing {
 public:
  explicit HWY_INLINE Packing(hn::Mask<Floats> kept) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(kF, kept, bits);
    count_ = hn::CountTrue(kF, kept);
    const hn::Rebind<std::uint8_t, Ints> d8;
    from_ = hn::PromoteTo(kI, hn::LoadU(d8, kSetBits[bits[0]].data()));
  }
  HWY_INLINE VF operator()(VF v) const {
    return hn::TableLookupLanes(v, hn::IndicesFromVec(kF, from_));
  }
  HWY_INLINE VI operator()(VI v) const {
    return hn::TableLookupLanes(v, hn::IndicesFromVec(kI, from_));
  }
  HWY_INLINE std::size_t count() const { return count_; }

 private:
  VI from_;
  std::size_t count_;
};
#endif

// A vector of points on their way through the kernel.
struct Lanes {
  VI at;  // index into CollectedPoints
  VI voxel[3];
  VF fraction[3], normal[3];
  hn::Mask<Ints> wanted;
};

// Points that were picked out, until they fill vectors.
struct Picked {
  static constexpr std::size_t kPoints = 256;
  static constexpr std::size_t kRoom = kPoints + kLanes;

  HWY_ALIGN std::int32_t at[kRoom] = {};
  HWY_ALIGN std::int32_t voxel[3][kRoom] = {};
  HWY_ALIGN float fraction[3][kRoom] = {};
  HWY_ALIGN float normal[3][kRoom] = {};
  std::size_t count = 0;
};

// Pushes the points in values 1 and 2, or measures all points (ForceField::measure).
template <bool kAllPoints>
class Kernel {
 public:
  Kernel(const CollectedPoints& points, const LevelScale& scale, LevelBricks& bricks,
         FieldSamples& samples)
      : points_(points), scale_(scale), bricks_(bricks), samples_(samples) {}

  // Picking the points out first is worth its while only where many are not wanted.
  HWY_INLINE void run() {
    samples_.count = 0;
    const std::uint32_t band = points_.surface_count + points_.interior_count;
    if (kAllPoints || band >= points_.count - points_.count / 4) {
      for (std::uint32_t first = 0; first < points_.count; first += kLanes) {
        push_lanes(load(first, wanted_of(first)));
      }
      return;
    }
    Picked picked;
    for (std::uint32_t first = 0; first < points_.count;) {
      picked.count = 0;
      for (; first < points_.count && picked.count < Picked::kPoints; first += kLanes) {
        pick(first, picked);
      }
      for (std::size_t i = 0; i < picked.count; i += kLanes) push_lanes(load(picked, i));
    }
  }

 private:
  HWY_INLINE hn::Mask<Ints> wanted_of(std::uint32_t first) const {
    const auto real = hn::FirstN(kI, points_.count - first);
    if (kAllPoints) return real;
    const hn::Rebind<std::uint8_t, Ints> d8;
    const VI value = hn::PromoteTo(kI, hn::LoadU(d8, &points_.value[first]));
    return hn::And(real, hn::Lt(value, hn::Set(kI, static_cast<int>(VoxelValue::kProximity))));
  }

  HWY_INLINE Lanes load(std::uint32_t first, hn::Mask<Ints> wanted) const {
    Lanes lanes;
    lanes.at = hn::Iota(kI, static_cast<std::int32_t>(first));
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
      lanes.normal[axis] = hn::Load(kF, picked.normal[axis] + i);
    }
    lanes.wanted = hn::FirstN(kI, picked.count - i);
    return lanes;
  }

  // Appends the next lanes' points in values 1 and 2.
  HWY_INLINE void pick(std::uint32_t first, Picked& picked) const {
    const auto wanted = wanted_of(first);
    if (hn::AllFalse(kI, wanted)) return;
    const Packing pack(hn::RebindMask(kF, wanted));
    const Lanes lanes = load(first, wanted);
    const std::size_t to = picked.count;
    hn::StoreU(pack(lanes.at), kI, picked.at + to);
    for (int axis = 0; axis < 3; ++axis) {
      hn::StoreU(pack(lanes.voxel[axis]), kI, picked.voxel[axis] + to);
      hn::StoreU(pack(lanes.fraction[axis]), kF, picked.fraction[axis] + to);
      hn::StoreU(pack(lanes.normal[axis]), kF, picked.normal[axis] + to);
    }
    picked.count += pack.count();
  }

  HWY_INLINE void push_lanes(const Lanes& lanes) {
    if (!kAllPoints && hn::AllFalse(kI, lanes.wanted)) return;
    VF slope[3], phi, u[3];
    sample(gather(lanes), lanes.fraction, phi, slope);
    push(phi, slope, lanes.normal, u);
    const VF one = hn::Set(kF, 1.0f), size_m = hn::Set(kF, scale_.voxel_size_m);
    const VF length = hn::Sqrt(dot(u, u));
    const auto directed = hn::Gt(length, hn::Set(kF, kTiny));
    const VF per_length = hn::Div(one, length);
    const VF strength = hn::Min(hn::Mul(length, hn::Set(kF, kWeak)), one);
    for (int axis = 0; axis < 3; ++axis) u[axis] = hn::Mul(u[axis], per_length);
    VF depth_m = hn::Mul(hn::Mul(hn::Neg(phi), strength), size_m);
    if (!scale_.euclidean_layers) {
      depth_m = hn::Mul(depth_m, hn::Add(hn::Add(hn::Abs(u[0]), hn::Abs(u[1])), hn::Abs(u[2])));
    }
    auto kept = hn::RebindMask(kF, lanes.wanted);
    if (kAllPoints) {
      const VF nothing = hn::Neg(hn::Mul(hn::Max(phi, hn::Zero(kF)), size_m));
      depth_m = hn::IfThenElse(directed, depth_m, nothing);
      for (int n = 0; n < 3; ++n) u[n] = hn::IfThenElse(directed, u[n], lanes.normal[n]);
    } else {
      kept = hn::And(kept, hn::And(hn::Lt(phi, hn::Zero(kF)), directed));
    }
    store(Packing(kept), lanes.at, depth_m, u, slope);
  }

  HWY_INLINE void store(const Packing& pack, VI at, VF depth_m, const VF (&direction)[3],
                        const VF (&slope)[3]) {
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

  // The 27 levels around the points.
  HWY_INLINE Planes gather(const Lanes& lanes) {
    const VI(&voxel)[3] = lanes.voxel;
    VI brick[3];
    for (int axis = 0; axis < 3; ++axis) brick[axis] = hn::ShiftRight<3>(voxel[axis]);
    const auto& strides = bricks_.strides();
    const VI key = hn::Add(
        hn::Add(hn::Mul(brick[0], constant(strides[0])), hn::Mul(brick[1], constant(strides[1]))),
        brick[2]);
    const hn::RebindToUnsigned<Ints> u32;
    const VI slot = hn::BitCast(kI, hn::ShiftRight<32 - LevelBricks::kSlotBits>(hn::BitCast(
                                        u32, hn::Mul(key, constant(LevelBricks::kHash)))));
    const auto* keys = reinterpret_cast<const std::int32_t*>(bricks_.keys());
    auto held = hn::Eq(hn::GatherIndex(kI, keys, slot), key);
    if (HWY_UNLIKELY(!bricks_.keys_are_unique())) held = hn::And(held, tags_match(slot, brick));

    // Shifts and sums rather than products, which are slow for this width.
    static_assert(LevelBricks::kBrickBytes == 960 && LevelBricks::kPlaneBytes == 96 &&
                  LevelBricks::kRowBytes == 12);
    const VI seven = hn::Set(kI, 7);
    const VI x = hn::And(voxel[0], seven), y = hn::And(voxel[1], seven);
    const VI at_brick = hn::Sub(hn::ShiftLeft<10>(slot), hn::ShiftLeft<6>(slot));
    const VI at_plane = hn::Add(hn::ShiftLeft<6>(x), hn::ShiftLeft<5>(x));
    const VI at_row = hn::Add(hn::ShiftLeft<3>(y), hn::ShiftLeft<2>(y));
    const VI offset =
        hn::Add(hn::Add(at_brick, at_plane), hn::Add(at_row, hn::And(voxel[2], seven)));
    Planes planes;
    for (std::uint32_t plane = 0; plane < 3; ++plane) {
      const std::uint8_t* base = bricks_.levels() + plane * LevelBricks::kPlaneBytes;
      planes.words[plane] =
          hn::GatherOffset(kI, reinterpret_cast<const std::int32_t*>(base), offset);
    }
    const auto missing = hn::AndNot(held, lanes.wanted);
    if (HWY_UNLIKELY(!hn::AllFalse(kI, missing))) fetch_missing(lanes, missing, planes);
    return planes;
  }

  HWY_INLINE hn::Mask<Ints> tags_match(VI slot, const VI (&brick)[3]) {
    const VI at = hn::ShiftLeft<2>(slot);
    auto match = hn::Eq(hn::GatherIndex(kI, bricks_.tags(), at), brick[0]);
    match = hn::And(match, hn::Eq(hn::GatherIndex(kI, bricks_.tags() + 1, at), brick[1]));
    return hn::And(match, hn::Eq(hn::GatherIndex(kI, bricks_.tags() + 2, at), brick[2]));
  }

  // Decodes the bricks that were not held. One of them may replace another, so each point's words
  // are taken while its brick is there.
  HWY_NOINLINE void fetch_missing(const Lanes& lanes, hn::Mask<Ints> missing, Planes& planes) {
    HWY_ALIGN std::int32_t words[3][kLanes], voxel[3][kLanes];
    HWY_ALIGN std::int32_t wanted[kLanes];
    for (int plane = 0; plane < 3; ++plane) hn::Store(planes.words[plane], kI, words[plane]);
    for (int axis = 0; axis < 3; ++axis) hn::Store(lanes.voxel[axis], kI, voxel[axis]);
    hn::Store(hn::VecFromMask(kI, missing), kI, wanted);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (wanted[lane] == 0) continue;
      const std::int32_t x = voxel[0][lane], y = voxel[1][lane], z = voxel[2][lane];
      const std::uint8_t* levels = bricks_.hold(x >> 3, y >> 3, z >> 3);
      levels += (x & 7) * std::int32_t{LevelBricks::kPlaneBytes} +
                (y & 7) * std::int32_t{LevelBricks::kRowBytes} + (z & 7);
      for (std::uint32_t plane = 0; plane < 3; ++plane) {
        hwy::CopyBytes<4>(levels + plane * LevelBricks::kPlaneBytes, &words[plane][lane]);
      }
    }
    for (int plane = 0; plane < 3; ++plane) planes.words[plane] = hn::Load(kI, words[plane]);
  }

  static HWY_INLINE VI constant(std::uint32_t value) {
    return hn::Set(kI, static_cast<std::int32_t>(value));
  }

  const CollectedPoints& points_;
  const LevelScale& scale_;
  LevelBricks& bricks_;
  FieldSamples& samples_;
};

void push_on_target(const CollectedPoints& points, const LevelScale& scale, LevelBricks& bricks,
                    FieldSamples& samples) {
  Kernel<false>(points, scale, bricks, samples).run();
}

void measure_on_target(const CollectedPoints& points, const LevelScale& scale, LevelBricks& bricks,
                       FieldSamples& samples) {
  Kernel<true>(points, scale, bricks, samples).run();
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer {

HWY_EXPORT(push_on_target);
HWY_EXPORT(measure_on_target);

void push_by_levels(const CollectedPoints& points, const LevelScale& scale, LevelBricks& bricks,
                    FieldSamples& samples) noexcept {
  HWY_DYNAMIC_DISPATCH(push_on_target)(points, scale, bricks, samples);
}

void measure_by_levels(const CollectedPoints& points, const LevelScale& scale, LevelBricks& bricks,
                       FieldSamples& samples) noexcept {
  HWY_DYNAMIC_DISPATCH(measure_on_target)(points, scale, bricks, samples);
}

}  // namespace forcelayer
#endif

#include "runtime/distance_push.h"

// Compiles what follows once per instruction set.
#include "runtime/vector_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/distance_push.cpp"
#include <hwy/foreach_target.h>
// Behind foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include "runtime/field_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace forcelayer {
namespace HWY_NAMESPACE {
namespace {

// Codes in bytes 0 and 1 of the lanes, more by kRaised[kByte]: they are written behind the exponent
// of that number, where a unit of them is one. Differences need no more than that.
constexpr float kRaised[2] = {0x1p23f, 0x1p15f};
template <int kByte>
HWY_INLINE VF raised(VI words) {
  const VI bits = hn::And(words, hn::Set(kI, 255 << (8 * kByte)));
  return hn::BitCast(kF, hn::Or(bits, hn::BitCast(kI, hn::Set(kF, kRaised[kByte]))));
}

HWY_INLINE VF mix(VF a, VF b, VF share) { return hn::Add(a, hn::Mul(share, hn::Sub(b, a))); }

// Codes at one x and y, between z and z + 1, from the words there; and their step along z.
template <int kByte>
HWY_INLINE VF between_words(VI low, VI high, VF share, VF& step) {
  const VF code = raised<kByte>(low);
  step = hn::Sub(raised<kByte>(high), code);
  return hn::Add(hn::Sub(code, hn::Set(kF, kRaised[kByte])), hn::Mul(share, step));
}

// Codes between the corners of a cell, and their slope per voxel, from the cell's words.
HWY_INLINE VF between_corners(VI low, VI high, const VF (&share)[3], VF (&slope)[3]) {
  VF at_x[2], step_y[2], step_z_x[2];
  for (int x = 0; x < 2; ++x) {
    VF step_z[2];
    const VF at_y0 = between_words<0>(low, high, share[2], step_z[0]);
    const VF at_y1 = between_words<1>(low, high, share[2], step_z[1]);
    step_y[x] = hn::Sub(at_y1, at_y0);
    at_x[x] = hn::Add(at_y0, hn::Mul(share[1], step_y[x]));
    step_z_x[x] = mix(step_z[0], step_z[1], share[1]);
    low = hn::ShiftRight<16>(low);
    high = hn::ShiftRight<16>(high);
  }
  slope[0] = hn::Sub(at_x[1], at_x[0]);
  slope[1] = mix(step_y[0], step_y[1], share[0]);
  slope[2] = mix(step_z_x[0], step_z_x[1], share[0]);
  return hn::Add(at_x[0], hn::Mul(share[0], slope[0]));
}

// Loads pairs of numbers apart. Highway's own LoadInterleaved2 takes twice the shuffles.
HWY_INLINE void load_pairs(const std::int32_t* pairs, VI& first, VI& second) {
#if HWY_TARGET == HWY_SCALAR
  hn::LoadInterleaved2(kI, pairs, first, second);
#else
  const VI low = hn::Load(kI, pairs), high = hn::Load(kI, pairs + kLanes);
  first = hn::ConcatEven(kI, high, low);
  second = hn::ConcatOdd(kI, high, low);
#endif
}

// What the stages hand on for the points of a chunk.
struct Stages {
  HWY_ALIGN std::int32_t words[2 * kChunk];  // two of each point's cell
  HWY_ALIGN float share[3][kChunk];          // where between the cell's corners the point lies
};

// Pushes the points in values 1 and 2, or measures all points (ForceField::measure).
template <bool kAllPoints>
class Kernel : public FieldKernel<Kernel<kAllPoints>, DistanceBricks, kAllPoints> {
  using Base = FieldKernel<Kernel<kAllPoints>, DistanceBricks, kAllPoints>;
  using Base::bricks_;
  using Base::points_;

 public:
  static constexpr bool kPicksNormals = false;

  Kernel(const CollectedPoints& points, const DistanceCodes& codes, DistanceBricks& bricks,
         FieldSamples& samples)
      : Base(points, bricks, samples), codes_(codes) {}

  // The first `count` points that load(i), load(i + kLanes), ... give.
  template <class Load>
  HWY_INLINE void push_chunk(std::size_t count, const Load& load) {
    for (std::size_t i = 0; i < count; i += kLanes) gather(load(i), i);
    for (std::size_t i = 0; i < count; i += kLanes) {
      VF share[3];
      for (int n = 0; n < 3; ++n) share[n] = hn::Load(kF, stages_.share[n] + i);
      VI low, high;
      load_pairs(stages_.words + 2 * i, low, high);
      push_lanes(load(i), low, high, share);
    }
  }

 private:
  HWY_INLINE void push_lanes(const Lanes& lanes, VI low, VI high, const VF (&share)[3]) {
    VF slope[3];
    const VF code = between_corners(low, high, share, slope);
    const VF step = hn::Set(kF, codes_.voxels_per_code);
    const VF phi = hn::Mul(hn::Sub(code, hn::Set(kF, codes_.zero_code)), step);
    for (int n = 0; n < 3; ++n) slope[n] = hn::Mul(slope[n], step);
    push(lanes, phi, slope);
  }

  HWY_INLINE void push(const Lanes& lanes, VF phi, const VF (&slope)[3]) {
    const VF one = hn::Set(kF, 1.0f), size_m = hn::Set(kF, codes_.voxel_size_m);
    const VF depth = hn::Neg(phi);
    VF u[3] = {slope[0], slope[1], slope[2]};
    // Most contacts are less than a voxel deep. There the normal counts nothing, and nothing lies
    // beyond: the same numbers without them.
    VF beyond = hn::Zero(kF);
    if (HWY_UNLIKELY(!hn::AllFalse(kF, hn::Gt(depth, one)))) beyond = push_deep(lanes, depth, u);
    const VF length = hn::Sqrt(dot(u, u));
    const auto directed = hn::Gt(length, hn::Set(kF, kNoDirection));
    const VF per_length = hn::Div(one, length);
    for (int n = 0; n < 3; ++n) u[n] = hn::Mul(u[n], per_length);
    const VF strength = hn::Min(hn::Mul(length, hn::Set(kF, 1 / kLeastSlope)), one);
    VF depth_m = hn::Mul(hn::Mul(hn::Add(hn::Min(depth, one), beyond), strength), size_m);
    auto kept = hn::RebindMask(kF, lanes.wanted);
    if (kAllPoints) {
      const VF nothing = hn::Mul(hn::Min(depth, hn::Zero(kF)), size_m);
      depth_m = hn::IfThenElse(directed, depth_m, nothing);
      for (int n = 0; n < 3; ++n) u[n] = hn::IfThenElse(directed, u[n], lanes.normal[n]);
    } else {
      kept = hn::And(kept, hn::And(hn::Gt(depth, hn::Zero(kF)), directed));
    }
    this->store(kept, lanes.at, depth_m, u, slope);
  }

  // Adds the part's normal to the slope `u` where it counts; what the depth is beyond a voxel, as
  // far as it has a slope.
  HWY_INLINE VF push_deep(const Lanes& lanes, VF depth, VF (&u)[3]) const {
    const VF one = hn::Set(kF, 1.0f);
    const VF certain = hn::Min(hn::Mul(hn::Sqrt(dot(u, u)), hn::Set(kF, 1 / kLeastSlope)), one);
    const VF buried =
        clamp01(hn::Mul(hn::Sub(depth, hn::Set(kF, kBuriedVoxels)), hn::Set(kF, 2.0f)));
    const VF along_normal = hn::Mul(hn::Set(kF, kBeyondSlope), buried);
    const float* normal[3] = {points_.nx.data(), points_.ny.data(), points_.nz.data()};
    for (int n = 0; n < 3; ++n) {
      u[n] = hn::Add(u[n], hn::Mul(along_normal, hn::GatherIndex(kF, normal[n], lanes.at)));
    }
    return hn::Mul(hn::Max(hn::Sub(depth, one), hn::Zero(kF)), certain);
  }

  // The shares and the corners of the points' cells, to the stages' numbers from i on.
  HWY_INLINE void gather(const Lanes& lanes, std::size_t i) {
    const VF half = hn::Set(kF, 0.5f), one = hn::Set(kF, 1.0f);
    VI cell[3];  // its lowest voxel: the point's, or the one before it
    for (int n = 0; n < 3; ++n) {
      const auto before = hn::Lt(lanes.fraction[n], half);
      const VF shifted = hn::Sub(lanes.fraction[n], half);
      hn::Store(hn::IfThenElse(before, hn::Add(shifted, one), shifted), kF, stages_.share[n] + i);
      cell[n] = hn::Add(lanes.voxel[n], hn::VecFromMask(kI, hn::RebindMask(kI, before)));
    }
    const auto [slot, held] = this->find(cell);
    static_assert(DistanceBricks::kPlaneBytes == 8 * 36 && DistanceBricks::kRowBytes == 36);
    const VI seven = hn::Set(kI, 7);
    const VI row = hn::Add(hn::ShiftLeft<3>(hn::And(cell[0], seven)), hn::And(cell[1], seven));
    const VI word = hn::Add(hn::Add(hn::ShiftLeft<3>(row), row), hn::And(cell[2], seven));
    const VI in_brick = hn::ShiftLeft<2>(word);
    constexpr auto kBrick = static_cast<std::int32_t>(DistanceBricks::kBrickBytes);
    // Point by point: two words at once, which no gather of this width fetches.
    HWY_ALIGN std::int32_t offsets[kLanes];
    hn::Store(hn::Add(hn::Mul(slot, hn::Set(kI, kBrick)), in_brick), kI, offsets);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      hwy::CopyBytes<8>(bricks_.codes() + offsets[lane], &stages_.words[2 * (i + lane)]);
    }
    const auto missing = hn::AndNot(held, lanes.wanted);
    if (HWY_LIKELY(hn::AllFalse(kI, missing))) return;
    this->fetch(cell, in_brick, missing, [&](std::size_t lane, const std::uint8_t* codes) {
      hwy::CopyBytes<8>(codes, &stages_.words[2 * (i + lane)]);
    });
  }

  const DistanceCodes& codes_;
  Stages stages_;
};

void push_on_target(const CollectedPoints& points, const DistanceCodes& codes,
                    DistanceBricks& bricks, FieldSamples& samples) {
  Kernel<false>(points, codes, bricks, samples).run();
}

void measure_on_target(const CollectedPoints& points, const DistanceCodes& codes,
                       DistanceBricks& bricks, FieldSamples& samples) {
  Kernel<true>(points, codes, bricks, samples).run();
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer {

HWY_EXPORT(push_on_target);
HWY_EXPORT(measure_on_target);

void push_by_distance(const CollectedPoints& points, const DistanceCodes& codes,
                      DistanceBricks& bricks, FieldSamples& samples) noexcept {
  HWY_DYNAMIC_DISPATCH(push_on_target)(points, codes, bricks, samples);
}

void measure_by_distance(const CollectedPoints& points, const DistanceCodes& codes,
                         DistanceBricks& bricks, FieldSamples& samples) noexcept {
  HWY_DYNAMIC_DISPATCH(measure_on_target)(points, codes, bricks, samples);
}

}  // namespace forcelayer
#endif

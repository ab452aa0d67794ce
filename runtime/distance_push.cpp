#include "runtime/distance_push.h"

// Vectors stand in arrays here, which those of unknown size cannot.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
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

// A code of four in each lane.
template <int kByte>
HWY_INLINE VF code_at(VI word) {
  const VI byte = hn::And(hn::ShiftRight<8 * kByte>(word), hn::Set(kI, 255));
  return hn::ConvertTo(kF, byte);
}

HWY_INLINE VF mix(VF a, VF b, VF share) { return hn::Add(a, hn::Mul(share, hn::Sub(b, a))); }

// Codes between the corners of a cell, and their slope per voxel, from the words of its two planes
// along x: bytes y + 2 z.
HWY_INLINE VF between_corners(const VI (&planes)[2], const VF (&share)[3], VF (&slope)[3]) {
  VF at_y[2][2], step_z[2][2];  // [x][y], z done with
  for (int x = 0; x < 2; ++x) {
    const VF c00 = code_at<0>(planes[x]), c10 = code_at<1>(planes[x]), c01 = code_at<2>(planes[x]),
             c11 = code_at<3>(planes[x]);
    step_z[x][0] = hn::Sub(c01, c00);
    step_z[x][1] = hn::Sub(c11, c10);
    at_y[x][0] = hn::Add(c00, hn::Mul(share[2], step_z[x][0]));
    at_y[x][1] = hn::Add(c10, hn::Mul(share[2], step_z[x][1]));
  }
  VF at_x[2], step_y[2], step_z_x[2];
  for (int x = 0; x < 2; ++x) {
    step_y[x] = hn::Sub(at_y[x][1], at_y[x][0]);
    at_x[x] = hn::Add(at_y[x][0], hn::Mul(share[1], step_y[x]));
    step_z_x[x] = mix(step_z[x][0], step_z[x][1], share[1]);
  }
  slope[0] = hn::Sub(at_x[1], at_x[0]);
  slope[1] = mix(step_y[0], step_y[1], share[0]);
  slope[2] = mix(step_z_x[0], step_z_x[1], share[0]);
  return hn::Add(at_x[0], hn::Mul(share[0], slope[0]));
}

// What the stages hand on for the points of a chunk.
struct Stages {
  HWY_ALIGN std::int32_t words[2][kChunk];  // the planes of each point's cell
};

// Pushes the points in values 1 and 2, or measures all points (ForceField::measure).
template <bool kAllPoints>
class Kernel : public FieldKernel<Kernel<kAllPoints>, DistanceBricks, kAllPoints> {
  using Base = FieldKernel<Kernel<kAllPoints>, DistanceBricks, kAllPoints>;
  using Base::bricks_;

 public:
  Kernel(const CollectedPoints& points, const DistanceCodes& codes, DistanceBricks& bricks,
         FieldSamples& samples)
      : Base(points, bricks, samples), codes_(codes) {}

  // The first `count` points that load(i), load(i + kLanes), ... give.
  template <class Load>
  HWY_INLINE void push_chunk(std::size_t count, const Load& load) {
    for (std::size_t i = 0; i < count; i += kLanes) gather(load(i), i);
    for (std::size_t i = 0; i < count; i += kLanes) {
      const Lanes lanes = load(i);
      const VI planes[2] = {hn::Load(kI, stages_.words[0] + i), hn::Load(kI, stages_.words[1] + i)};
      push_lanes(lanes, planes);
    }
  }

 private:
  HWY_INLINE void push_lanes(const Lanes& lanes, const VI (&planes)[2]) {
    // A cell lies between voxel centres.
    const VF half = hn::Set(kF, 0.5f), one = hn::Set(kF, 1.0f);
    VF share[3];
    for (int n = 0; n < 3; ++n) {
      const auto low = hn::Lt(lanes.fraction[n], half);
      const VF shifted = hn::Sub(lanes.fraction[n], half);
      share[n] = hn::IfThenElse(low, hn::Add(shifted, one), shifted);
    }
    VF slope[3];
    const VF code = between_corners(planes, share, slope);
    const VF step = hn::Set(kF, codes_.voxels_per_code);
    const VF phi = hn::Mul(hn::Sub(code, hn::Set(kF, codes_.zero_code)), step);
    for (int n = 0; n < 3; ++n) slope[n] = hn::Mul(slope[n], step);
    push(lanes, phi, slope);
  }

  HWY_INLINE void push(const Lanes& lanes, VF phi, const VF (&slope)[3]) {
    const VF one = hn::Set(kF, 1.0f), size_m = hn::Set(kF, codes_.voxel_size_m);
    const VF depth = hn::Neg(phi);
    const VF buried =
        clamp01(hn::Mul(hn::Sub(depth, hn::Set(kF, kBuriedVoxels)), hn::Set(kF, 2.0f)));
    const VF along_normal = hn::Mul(hn::Set(kF, kBeyondSlope), buried);
    VF u[3];
    for (int n = 0; n < 3; ++n) u[n] = hn::Add(slope[n], hn::Mul(along_normal, lanes.normal[n]));
    const VF length = hn::Sqrt(dot(u, u));
    const auto directed = hn::Gt(length, hn::Set(kF, kNoDirection));
    const VF per_length = hn::Div(one, length);
    for (int n = 0; n < 3; ++n) u[n] = hn::Mul(u[n], per_length);
    const VF strength = hn::Min(hn::Mul(length, hn::Set(kF, 1 / kLeastSlope)), one);
    // Beyond a voxel depth counts as far as it has a slope.
    const VF certain =
        hn::Min(hn::Mul(hn::Sqrt(dot(slope, slope)), hn::Set(kF, 1 / kLeastSlope)), one);
    const VF beyond = hn::Mul(hn::Max(hn::Sub(depth, one), hn::Zero(kF)), certain);
    VF depth_m = hn::Mul(hn::Mul(hn::Add(hn::Min(depth, one), beyond), strength), size_m);
    auto kept = hn::RebindMask(kF, lanes.wanted);
    if (kAllPoints) {
      const VF nothing = hn::Mul(hn::Min(depth, hn::Zero(kF)), size_m);
      depth_m = hn::IfThenElse(directed, depth_m, nothing);
      for (int n = 0; n < 3; ++n) u[n] = hn::IfThenElse(directed, u[n], lanes.normal[n]);
    } else {
      kept = hn::And(kept, hn::And(hn::Gt(depth, hn::Zero(kF)), directed));
    }
    this->store(Packing(kept), lanes.at, depth_m, u, slope);
  }

  // From a voxel of a brick to the lowest corner of the cell that holds the point: one voxel less
  // where the point lies in the lower half; one more for the halo. In bytes of the brick.
  static HWY_INLINE VI cell_offset(const Lanes& lanes) {
    const VI seven = hn::Set(kI, 7);
    VI cell[3];
    for (int n = 0; n < 3; ++n) {
      const auto upper = hn::RebindMask(kI, hn::Ge(lanes.fraction[n], hn::Set(kF, 0.5f)));
      cell[n] = hn::Sub(hn::And(lanes.voxel[n], seven), hn::VecFromMask(kI, upper));
    }
    static_assert(DistanceBricks::kPlaneBytes == 180 && DistanceBricks::kRowBytes == 20);
    const VI planes = hn::Add(hn::ShiftLeft<3>(cell[0]), cell[0]);             // 9 x
    const VI rows = hn::Add(planes, cell[1]);                                  // 9 x + y
    const VI pairs = hn::Add(hn::ShiftLeft<3>(rows), hn::ShiftLeft<1>(rows));  // 10 (9 x + y)
    return hn::ShiftLeft<1>(hn::Add(pairs, cell[2]));
  }

  // The corners of the points' cells, to words[.][i] on.
  HWY_INLINE void gather(const Lanes& lanes, std::size_t i) {
    const auto [slot, held] = this->find(lanes.voxel);
    constexpr auto kBrick = static_cast<std::int32_t>(DistanceBricks::kBrickBytes);
    const VI offset = hn::Add(hn::Mul(slot, hn::Set(kI, kBrick)), cell_offset(lanes));
    for (std::uint32_t plane = 0; plane < 2; ++plane) {
      const auto* base = reinterpret_cast<const std::int32_t*>(bricks_.codes() +
                                                               plane * DistanceBricks::kPlaneBytes);
      hn::Store(hn::GatherOffset(kI, base, offset), kI, stages_.words[plane] + i);
    }
    const auto missing = hn::AndNot(held, lanes.wanted);
    if (HWY_UNLIKELY(!hn::AllFalse(kI, missing))) fetch_missing(lanes, missing, i);
  }

  // Decodes the bricks that were not held. One of them may replace another, so each point's words
  // are taken while its brick is there.
  HWY_NOINLINE void fetch_missing(const Lanes& lanes, hn::Mask<Ints> missing, std::size_t i) {
    HWY_ALIGN std::int32_t voxel[3][kLanes];
    HWY_ALIGN std::int32_t offset[kLanes];
    HWY_ALIGN std::int32_t wanted[kLanes];
    for (int axis = 0; axis < 3; ++axis) hn::Store(lanes.voxel[axis], kI, voxel[axis]);
    hn::Store(cell_offset(lanes), kI, offset);
    hn::Store(hn::VecFromMask(kI, missing), kI, wanted);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (wanted[lane] == 0) continue;
      const std::uint8_t* codes =
          bricks_.hold(voxel[0][lane] >> 3, voxel[1][lane] >> 3, voxel[2][lane] >> 3);
      codes += offset[lane];
      for (std::uint32_t plane = 0; plane < 2; ++plane) {
        hwy::CopyBytes<4>(codes + plane * DistanceBricks::kPlaneBytes,
                          &stages_.words[plane][i + lane]);
      }
    }
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

// The distance field's arithmetic (distance_field.h) for sixteen, eight or four points at a time,
// by the widest vectors that the machine has. It has no fused multiply-add, so every width gives
// the same bits.
#include "runtime/field/distance_field.h"

// Compiles what follows once per instruction set.
#include "runtime/query/vector_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/field/distance_field_kernel.cpp"
#include <hwy/foreach_target.h>
// Behind foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include <algorithm>
#include <bit>

#include "runtime/field/field_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace forcelayer::field {
namespace HWY_NAMESPACE {
namespace {

// The constants of the push in distance_field.h.
constexpr float kBeyondSlope = 0.05f;  // fraction of the normal that counts beside the slope
constexpr float kBuriedVoxels = 1.5f;  // depth from which it begins to; half a voxel later in full
constexpr float kNoDirection = 1e-6f;  // a shorter vector has no direction

// Codes in byte 0 or 1 of the lanes as floats, plus kRaised[kByte]: the code's bits are put into
// the mantissa of that number, where the code's lowest bit is worth one. Differences come out
// exact.
constexpr float kRaised[2] = {0x1p23f, 0x1p15f};
template <int kByte>
HWY_INLINE VF raised(VI words) {
  const VI bits = hn::And(words, hn::Set(kI, 255 << (8 * kByte)));
  return hn::BitCast(kF, hn::Or(bits, hn::BitCast(kI, hn::Set(kF, kRaised[kByte]))));
}

HWY_INLINE VF mix(VF a, VF b, VF between) { return hn::Add(a, hn::Mul(between, hn::Sub(b, a))); }

// Codes at one x and y, between z and z + 1, from the words there; and their step along z.
template <int kByte>
HWY_INLINE VF between_words(VI low, VI high, VF between, VF& step) {
  const VF code = raised<kByte>(low);
  step = hn::Sub(raised<kByte>(high), code);
  return hn::Add(hn::Sub(code, hn::Set(kF, kRaised[kByte])), hn::Mul(between, step));
}

// Codes between the corners of a cell, and their slope per voxel, from the cell's words.
HWY_INLINE VF between_corners(VI low, VI high, const VF (&between)[3], VF (&slope)[3]) {
  VF at_x[2], step_y[2], step_z_x[2];
  for (int x = 0; x < 2; ++x) {
    VF step_z[2];
    const VF at_y0 = between_words<0>(low, high, between[2], step_z[0]);
    const VF at_y1 = between_words<1>(low, high, between[2], step_z[1]);
    step_y[x] = hn::Sub(at_y1, at_y0);
    at_x[x] = hn::Add(at_y0, hn::Mul(between[1], step_y[x]));
    step_z_x[x] = mix(step_z[0], step_z[1], between[1]);
    low = hn::ShiftRight<16>(low);
    high = hn::ShiftRight<16>(high);
  }
  slope[0] = hn::Sub(at_x[1], at_x[0]);
  slope[1] = mix(step_y[0], step_y[1], between[0]);
  slope[2] = mix(step_z_x[0], step_z_x[1], between[0]);
  return hn::Add(at_x[0], hn::Mul(between[0], slope[0]));
}

// Squared distances from the mesh, in codes, between the corners of a cell: each is that of the
// code's lower bound, or 0 at and below the mesh.
template <int kByte>
HWY_INLINE VF squared_distance(VI words, VF mesh_code) {
  const VF raised_mesh = hn::Add(mesh_code, hn::Set(kF, kRaised[kByte]));
  const VF above = hn::Max(hn::Sub(raised<kByte>(words), raised_mesh), hn::Zero(kF));
  return hn::Mul(above, above);
}
HWY_INLINE VF squared_between_corners(VI low, VI high, const VF (&between)[3], VF mesh_code) {
  VF at_x[2];
  for (int x = 0; x < 2; ++x) {
    const VF at_y0 =
        mix(squared_distance<0>(low, mesh_code), squared_distance<0>(high, mesh_code), between[2]);
    const VF at_y1 =
        mix(squared_distance<1>(low, mesh_code), squared_distance<1>(high, mesh_code), between[2]);
    at_x[x] = mix(at_y0, at_y1, between[1]);
    low = hn::ShiftRight<16>(low);
    high = hn::ShiftRight<16>(high);
  }
  return mix(at_x[0], at_x[1], between[0]);
}

// Codes on one side of a cell, interpolated across it, from the words at its near and far edge.
template <int kNearByte, int kFarByte>
HWY_INLINE VF between_edges(VI near_low, VI near_high, VF along, VI far_low, VI far_high,
                            VF across) {
  VF step;
  const VF near = between_words<kNearByte>(near_low, near_high, along, step);
  return mix(near, between_words<kFarByte>(far_low, far_high, along, step), across);
}

// The slope along an axis, interpolated between the differences on both sides of the point's voxel
// center, each of which belongs to the middle between its two centers. `cell` is the difference in
// the point's cell, `code` the code at the point, `beside` the code beside the cell:
//   (1 - 3/2 |a| + a^2) cell + a (beside - code), a = between - 1/2
HWY_INLINE VF continued(VF cell, VF between, VF code, VF beside) {
  const VF a = hn::Sub(between, hn::Set(kF, 0.5f)), b = hn::Abs(a);
  const VF kept = hn::Add(hn::Mul(hn::Sub(b, hn::Set(kF, 1.5f)), b), hn::Set(kF, 1.0f));
  return hn::Add(hn::Mul(kept, cell), hn::Mul(a, hn::Sub(beside, code)));
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

// Loads fours of numbers apart.
HWY_INLINE void load_fours(const std::int32_t* fours, VI (&number)[4]) {
#if HWY_TARGET == HWY_SCALAR
  hn::LoadInterleaved4(kI, fours, number[0], number[1], number[2], number[3]);
#else
  VI even[2], odd[2];
  for (int half = 0; half < 2; ++half) {
    const VI low = hn::Load(kI, fours + 2 * kLanes * half);
    const VI high = hn::Load(kI, fours + 2 * kLanes * half + kLanes);
    even[half] = hn::ConcatEven(kI, high, low);
    odd[half] = hn::ConcatOdd(kI, high, low);
  }
  number[0] = hn::ConcatEven(kI, even[1], even[0]);
  number[1] = hn::ConcatEven(kI, odd[1], odd[0]);
  number[2] = hn::ConcatOdd(kI, even[1], even[0]);
  number[3] = hn::ConcatOdd(kI, odd[1], odd[0]);
#endif
}

// Copies kBytes from each of two places, at[0] and at[1] times kStride bytes behind `from`, side by
// side to `to`. The two numbers are read as one, because memory accesses are the limit here.
template <std::size_t kBytes, std::int64_t kStride = 1>
HWY_INLINE void copy_two(const void* from, const std::int32_t* at, void* to) {
  static_assert(std::endian::native == std::endian::little,
                "the first of two numbers must be the lower half");
  std::int64_t both;
  hwy::CopyBytes<8>(at, &both);
  const auto* bytes = static_cast<const std::uint8_t*>(from);
  auto* side_by_side = static_cast<std::uint8_t*>(to);
  hwy::CopyBytes<kBytes>(bytes + static_cast<std::int32_t>(both) * kStride, side_by_side);
  hwy::CopyBytes<kBytes>(bytes + (both >> 32) * kStride, side_by_side + kBytes);
}

// Results of the stages for the points of a chunk.
struct Stages {
  HWY_ALIGN float between[3][kChunk];  // the point's place between its cell's corners
  // Key and slot of the point's brick, and the offsets of its words: those around its cell along z,
  // those beside the cell in x and in y.
  HWY_ALIGN std::int32_t key[kChunk];
  HWY_ALIGN std::int32_t slot[kChunk];
  HWY_ALIGN std::int32_t tags_match[kChunk];  // only where keys are not unique
  HWY_ALIGN std::int32_t around_at[kChunk];
  HWY_ALIGN std::int32_t beside_x_at[kChunk];
  HWY_ALIGN std::int32_t beside_y_at[kChunk];
  // Read from there: the slot's key; four words, of which the middle two are the cell's; and on the
  // side of the point's voxel two words beside the cell in x (codes in bytes 0 and 1) and two in y
  // (bytes 0 and 2).
  HWY_ALIGN std::int32_t key_there[kChunk];
  HWY_ALIGN std::int32_t around[4 * kChunk];
  HWY_ALIGN std::int32_t beside_x[2 * kChunk];
  HWY_ALIGN std::int32_t beside_y[2 * kChunk];
};

// ForceField::measure.
class Kernel : public FieldKernel<DistanceBricks> {
 public:
  Kernel(const query::CollectedPoints& points, const DistanceScale& scale, DistanceBricks& bricks,
         FieldSamples& samples)
      : FieldKernel(points, bricks, samples), scale_(scale) {}

  HWY_INLINE void run() {
    for (std::size_t first = 0; first < points_.count; first += kChunk) {
      const std::size_t count = std::min(kChunk, points_.count - first);
      for (std::size_t i = 0; i < count; i += kLanes) locate(load(first + i), i);
      copy(hwy::RoundUpTo(count, kLanes));
      for (std::size_t i = 0; i < count; i += kLanes) push_lanes(first, i);
    }
  }

 private:
  // Lane i of the chunk from point `first` on, and those behind it.
  HWY_INLINE void push_lanes(std::size_t first, std::size_t i) {
    const Lanes lanes = load(first + i);
    auto held = hn::Eq(hn::Load(kI, stages_.key + i), hn::Load(kI, stages_.key_there + i));
    if (HWY_UNLIKELY(!bricks_.keys_are_unique())) {
      held = hn::And(held, hn::MaskFromVec(hn::Load(kI, stages_.tags_match + i)));
    }
    const auto missing = hn::AndNot(held, lanes.real);
    // Loaded anew: `lanes`, handed over by reference, would be written to the stack each time.
    if (HWY_UNLIKELY(!hn::AllFalse(kI, missing))) replace(load(first + i), i, missing);
    VF between[3], slope[3];
    for (int n = 0; n < 3; ++n) between[n] = hn::Load(kF, stages_.between[n] + i);
    VI around[4], low, high;
    load_fours(stages_.around + 4 * i, around);
    const VF code = between_corners(around[1], around[2], between, slope);
    load_pairs(stages_.beside_x + 2 * i, low, high);
    const VF beside_x = between_edges<0, 1>(low, high, between[2], low, high, between[1]);
    load_pairs(stages_.beside_y + 2 * i, low, high);
    const VF beside_y = between_edges<0, 0>(low, high, between[2], hn::ShiftRight<16>(low),
                                            hn::ShiftRight<16>(high), between[0]);
    const auto from_below = hn::RebindMask(kI, hn::Lt(between[2], hn::Set(kF, 0.5f)));
    low = hn::IfThenElse(from_below, around[0], around[3]);
    high = hn::ShiftRight<16>(low);
    const VF beside_z = between_edges<0, 1>(low, high, between[0], low, high, between[1]);
    const VF step = hn::Set(kF, scale_.voxels_per_code);
    hn::StoreU(hn::Mul(slope[0], step), kF, &samples_.ex[first + i]);
    hn::StoreU(hn::Mul(slope[1], step), kF, &samples_.ey[first + i]);
    hn::StoreU(hn::Mul(slope[2], step), kF, &samples_.ez[first + i]);
    slope[0] = hn::Mul(continued(slope[0], between[0], code, beside_x), step);
    slope[1] = hn::Mul(continued(slope[1], between[1], code, beside_y), step);
    slope[2] = hn::Mul(continued(slope[2], between[2], code, beside_z), step);
    const VF phi = hn::Mul(hn::Sub(code, hn::Set(kF, scale_.zero_code)), step);
    hn::StoreU(hn::Mul(phi, hn::Set(kF, scale_.voxel_size_m)), kF,
               &samples_.from_zero_force_m[first + i]);
    push(lanes, phi, slope, first + i);
    prove(squared_between_corners(around[1], around[2], between, hn::Set(kF, scale_.mesh_code)),
          between, first + i);
  }

  // The proven distance, from the interpolated squares (distance_field.h). The squares are whole
  // numbers below 2^16. Three levels of interpolation round each by at most 2^-24 of their size a
  // step, and a fraction is off by 2^-24: less than a tenth of a squared code together.
  HWY_INLINE void prove(VF squared_codes, const VF (&between)[3], std::size_t first) {
    constexpr float kRounding = 0.125f;  // squared codes
    const VF one = hn::Set(kF, 1.0f);
    VF spread = hn::Zero(kF);
    for (int n = 0; n < 3; ++n) {
      spread = hn::Add(spread, hn::Mul(between[n], hn::Sub(one, between[n])));
    }
    const VF lost = hn::Add(hn::Mul(spread, hn::Set(kF, scale_.squared_codes_per_voxel)),
                            hn::Set(kF, kRounding));
    const VF proven = hn::Max(hn::Sub(squared_codes, lost), hn::Zero(kF));
    // Less what these three roundings and that of the step itself can add.
    const VF code_m =
        hn::Set(kF, scale_.voxels_per_code * scale_.voxel_size_m * (1 - 4 * 0x1p-23f));
    hn::StoreU(hn::Mul(hn::Sqrt(proven), code_m), kF, &samples_.distance_m[first]);
  }

  HWY_INLINE void push(const Lanes& lanes, VF phi, const VF (&slope)[3], std::size_t first) {
    const VF one = hn::Set(kF, 1.0f), size_m = hn::Set(kF, scale_.voxel_size_m);
    const VF depth = hn::Neg(phi);
    VF u[3] = {slope[0], slope[1], slope[2]};
    // Most contacts are less than a voxel deep, where the normal does not count and no depth lies
    // beyond a voxel: leaving both out gives the same numbers.
    VF beyond = hn::Zero(kF);
    if (HWY_UNLIKELY(!hn::AllFalse(kF, hn::Gt(depth, one)))) beyond = push_deep(lanes, depth, u);
    const VF length = hn::Sqrt(dot(u, u));
    const auto directed = hn::Gt(length, hn::Set(kF, kNoDirection));
    const VF per_length = hn::Div(one, length);
    for (int n = 0; n < 3; ++n) u[n] = hn::Mul(u[n], per_length);
    const VF strength = hn::Min(hn::Mul(length, hn::Set(kF, 1 / kMinSlope)), one);
    VF depth_m = hn::Mul(hn::Mul(hn::Add(hn::Min(depth, one), beyond), strength), size_m);
    const VF nothing = hn::Mul(hn::Min(depth, hn::Zero(kF)), size_m);
    depth_m = hn::IfThenElse(directed, depth_m, nothing);
    for (int n = 0; n < 3; ++n) u[n] = hn::IfThenElse(directed, u[n], lanes.normal[n]);
    store(first, depth_m, u, slope);
  }

  // Adds the part's normal to the slope `u` where it counts. Returns the depth beyond a voxel, less
  // where the slope is weak.
  HWY_INLINE VF push_deep(const Lanes& lanes, VF depth, VF (&u)[3]) const {
    const VF one = hn::Set(kF, 1.0f);
    const VF certain = hn::Min(hn::Mul(hn::Sqrt(dot(u, u)), hn::Set(kF, 1 / kMinSlope)), one);
    const VF buried =
        clamp01(hn::Mul(hn::Sub(depth, hn::Set(kF, kBuriedVoxels)), hn::Set(kF, 2.0f)));
    const VF along_normal = hn::Mul(hn::Set(kF, kBeyondSlope), buried);
    for (int n = 0; n < 3; ++n) u[n] = hn::Add(u[n], hn::Mul(along_normal, lanes.normal[n]));
    return hn::Mul(hn::Max(hn::Sub(depth, one), hn::Zero(kF)), certain);
  }

  // First stage, from i on: finds the points' words.
  HWY_INLINE void locate(const Lanes& lanes, std::size_t i) {
    using Bricks = DistanceBricks;
    const VF half = hn::Set(kF, 0.5f), one = hn::Set(kF, 1.0f);
    const VI seven = hn::Set(kI, 7), size = hn::Set(kI, Bricks::kBrickBytes);
    constexpr std::int32_t kStrides[3] = {Bricks::kPlaneBytes, Bricks::kRowBytes, 4};
    // From a cell to the codes behind it, less the stride. Reading from a later byte on brings them
    // to the bytes where the codes before the cell stand.
    constexpr std::int32_t kBehind[2] = {kStrides[0] + 2, kStrides[1] + 1};
    const VI key = key_of(lanes.voxel);
    const VI slot = slot_of(key);
    VI at = hn::Add(hn::Mul(slot, size), hn::Set(kI, Bricks::kFirstBytes)), beside[2];
    for (int n = 0; n < 3; ++n) {
      // The cell's lowest voxel is the point's, or the one before it.
      const auto before = hn::Lt(lanes.fraction[n], half);
      const VF shifted = hn::Sub(lanes.fraction[n], half);
      hn::Store(hn::IfThenElse(before, hn::Add(shifted, one), shifted), kF, stages_.between[n] + i);
      const VI stride = hn::Set(kI, kStrides[n]);
      const auto is_before = hn::RebindMask(kI, before);
      at = hn::Add(at, hn::Mul(hn::And(lanes.voxel[n], seven), stride));
      at = hn::Sub(at, hn::IfThenElseZero(is_before, stride));
      if (n < 2) {
        beside[n] = hn::IfThenElse(is_before, hn::Set(kI, kBehind[n]), hn::Set(kI, -kStrides[n]));
      }
    }
    if (HWY_UNLIKELY(!bricks_.keys_are_unique())) {
      const auto match = tags_match(slot, lanes.voxel);
      hn::Store(hn::VecFromMask(kI, match), kI, stages_.tags_match + i);
    }
    hn::Store(key, kI, stages_.key + i);
    hn::Store(slot, kI, stages_.slot + i);
    hn::Store(hn::Sub(at, hn::Set(kI, 4)), kI, stages_.around_at + i);
    hn::Store(hn::Add(at, beside[0]), kI, stages_.beside_x_at + i);
    hn::Store(hn::Add(at, beside[1]), kI, stages_.beside_y_at + i);
  }

  // Second stage, two points at a time: copies the words, which are wider than a gather's lanes.
  HWY_INLINE void copy(std::size_t count) {
    const std::uint8_t* codes = bricks_.codes();
    const std::uint32_t* keys = bricks_.keys();
    std::size_t i = 0;
    for (; i + 1 < count; i += 2) {
      copy_two<4, 4>(keys, stages_.slot + i, stages_.key_there + i);
      copy_two<16>(codes, stages_.around_at + i, stages_.around + 4 * i);
      copy_two<8>(codes, stages_.beside_x_at + i, stages_.beside_x + 2 * i);
      copy_two<8>(codes, stages_.beside_y_at + i, stages_.beside_y + 2 * i);
    }
    if (i < count) {  // the last, where vectors have one lane
      hwy::CopyBytes<4>(keys + stages_.slot[i], stages_.key_there + i);
      take(codes, i);
    }
  }
  HWY_INLINE void take(const std::uint8_t* codes, std::size_t i) {
    hwy::CopyBytes<16>(codes + stages_.around_at[i], stages_.around + 4 * i);
    hwy::CopyBytes<8>(codes + stages_.beside_x_at[i], stages_.beside_x + 2 * i);
    hwy::CopyBytes<8>(codes + stages_.beside_y_at[i], stages_.beside_y + 2 * i);
  }

  // Third stage, where bricks were missing: decodes them and copies the points' words again.
  HWY_NOINLINE void replace(const Lanes& lanes, std::size_t i, hn::Mask<Ints> missing) {
    fetch(lanes.voxel, hn::Zero(kI), missing,
          [&](std::size_t lane, const std::uint8_t*) { take(bricks_.codes(), i + lane); });
  }

  const DistanceScale& scale_;
  Stages stages_;
};

void measure_on_target(const query::CollectedPoints& points, const DistanceScale& scale,
                       DistanceBricks& bricks, FieldSamples& samples) {
  Kernel(points, scale, bricks, samples).run();
}

// The codes of unknown voxels are those of known ones, which is no bound for a point in whose cell
// they stand.
void disprove_on_target(const query::CollectedPoints& points, const KnownBox& known,
                        FieldSamples& samples) {
  const std::int32_t* const voxel[3] = {points.vx.data(), points.vy.data(), points.vz.data()};
  const float* const fraction[3] = {points.fx.data(), points.fy.data(), points.fz.data()};
  // The lowest and the highest voxel that a cell may begin with. No point is near the ends of the
  // numbers: a directory has at most 2^30 voxels along a side, and a part a radius of 2^20.
  constexpr std::int64_t kFar = INT32_MAX;
  VI low[3], high[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = hn::Set(kI, static_cast<std::int32_t>(std::clamp(known.low[axis], -kFar, kFar)));
    high[axis] =
        hn::Set(kI, static_cast<std::int32_t>(std::clamp(known.high[axis] - 2, -kFar, kFar)));
  }
  for (std::size_t i = 0; i < points.count; i += kLanes) {
    auto unknown = hn::MaskFromVec(hn::Zero(kI));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto before = hn::Lt(hn::LoadU(kF, fraction[axis] + i), hn::Set(kF, 0.5f));
      const VI cell = hn::Sub(hn::LoadU(kI, voxel[axis] + i),
                              hn::IfThenElseZero(hn::RebindMask(kI, before), hn::Set(kI, 1)));
      unknown = hn::Or(unknown, hn::Or(hn::Lt(cell, low[axis]), hn::Gt(cell, high[axis])));
    }
    float* const distance_m = &samples.distance_m[i];
    hn::StoreU(hn::IfThenZeroElse(hn::RebindMask(kF, unknown), hn::LoadU(kF, distance_m)), kF,
               distance_m);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer::field
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::field {

HWY_EXPORT(measure_on_target);
HWY_EXPORT(disprove_on_target);

void DistanceField::measure(const query::CollectedPoints& points,
                            FieldSamples& samples) const noexcept {
  HWY_DYNAMIC_DISPATCH(measure_on_target)(points, scale_, bricks_, samples);
  if (cropped_) HWY_DYNAMIC_DISPATCH(disprove_on_target)(points, bricks_.known(), samples);
}

}  // namespace forcelayer::field
#endif

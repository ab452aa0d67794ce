// The level field's arithmetic (level_field.h) for sixteen, eight or four points at a time, by the
// widest vectors that the machine has. It has no fused multiply-add, so every width gives the same
// bits.
#include "runtime/field/level_field.h"

// Compiles what follows once per instruction set.
#include "runtime/query/vector_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/field/level_field_kernel.cpp"
#include <hwy/foreach_target.h>
// Behind foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

#include <algorithm>
#include <array>

#include "runtime/field/field_kernel-inl.h"

HWY_BEFORE_NAMESPACE();
namespace forcelayer::field {
namespace HWY_NAMESPACE {
namespace {

// The constants of the push in level_field.h.
constexpr float kDisagreeing = 0.5625f;  // squared cosine up to which the slope counts alone
constexpr float kAgreementGain = 16.0f;
constexpr float kBuried = -0.5f;  // phi below which the normal begins to count beside the slope
constexpr float kBuriedNormal = 0.05f;  // and how much
constexpr float kWeak = 10.0f;          // over the length below which a push fades
constexpr float kTiny = 1e-6f;          // a shorter vector has no direction

// Raised levels around `kLanes` points. A lane of words[x] holds those at z-1, z and z+1 in bytes 0
// to 2 and, within a byte, those at y-1, y and y+1 in bits 0, 2 and 4.
struct Planes {
  VI words[3];
};

// Sums of levels are kept in 16 bits, in units of 1/1024: the sums of eight raised levels, and
// their differences, stay below 2^15.
constexpr int kUnit = 1024;

#if HWY_TARGET == HWY_SCALAR
// The sums at the eight corners, times kUnit, between them along y and x.
struct Corners {
  std::int32_t sums[4][2] = {};  // [2 x + y][z]

  std::int32_t at(int z, std::int32_t fraction_x, std::int32_t fraction_y) const {
    return mix(mix(sums[0][z], sums[1][z], fraction_y), mix(sums[2][z], sums[3][z], fraction_y),
               fraction_x);
  }

 private:
  static std::int32_t mix(std::int32_t a, std::int32_t b, std::int32_t fraction) {
    return a + (((b - a) * fraction + 0x4000) >> 15);
  }
};

HWY_INLINE VF between_corners(const Corners& corners, const VF (&fraction)[3], float scale) {
  const auto fraction_x = static_cast<std::int32_t>(fraction[0].raw * 32768.0f);
  const auto fraction_y = static_cast<std::int32_t>(fraction[1].raw * 32768.0f);
  const auto low = static_cast<float>(corners.at(0, fraction_x, fraction_y));
  const auto high = static_cast<float>(corners.at(1, fraction_x, fraction_y));
  return VF((low + fraction[2].raw * (high - low)) * scale);
}

// phi (voxels) and its slope (per voxel) of one point, where the machine has no vectors.
HWY_INLINE void sample(const Planes& planes, const VF (&fraction)[3], VF& phi, VF (&slope)[3]) {
  Corners level, along[3];
  for (int corner = 0; corner < 8; ++corner) {
    for (int voxel = 0; voxel < 8; ++voxel) {
      const int up[3] = {voxel >> 2, voxel >> 1 & 1, voxel & 1};
      const int x = (corner >> 2) + up[0], y = (corner >> 1 & 1) + up[1], z = (corner & 1) + up[2];
      const std::int32_t raised = planes.words[x].raw >> (8 * z + 2 * y) & 3;
      level.sums[corner >> 1][corner & 1] += kUnit * raised;
      for (int axis = 0; axis < 3; ++axis) {
        along[axis].sums[corner >> 1][corner & 1] += up[axis] ? kUnit * raised : -kUnit * raised;
      }
    }
  }
  phi = VF(between_corners(level, fraction, 1.0f / (8 * kUnit)).raw - 1.0f);
  for (int axis = 0; axis < 3; ++axis) {
    slope[axis] = between_corners(along[axis], fraction, 1.0f / (4 * kUnit));
  }
}
#else
// A vector of lanes seen as numbers of 16 bits, two a lane, and of 8 bits, four a lane.
using Halves = hn::Repartition<std::int16_t, Ints>;
using Bytes = hn::Repartition<std::int8_t, Ints>;
using VH = hn::Vec<Halves>;
using VB = hn::Vec<Bytes>;
constexpr Halves kH;
constexpr Bytes kB;

// Bytes kFirst and kFirst + 1 of each lane in the high bytes of its two halves: 256 times as much.
template <int kFirst>
HWY_INLINE VH two_bytes(VB lanes) {
  constexpr auto kFrom = [] {
    std::array<std::int8_t, 16> from{};
    for (int n = 0; n < 16; ++n) {
      from[static_cast<std::size_t>(n)] =
          n % 2 == 0 ? std::int8_t{-1} : static_cast<std::int8_t>(n / 4 * 4 + kFirst + n % 4 / 2);
    }
    return from;
  }();
  return hn::BitCast(kH, hn::TableLookupBytesOr0(lanes, hn::LoadDup128(kB, kFrom.data())));
}

// Per corner of a voxel at one x and y ([2 x + y]) a sum over the voxels around it, times kUnit;
// those at z and z+1 are the halves of each lane.
using Corners = VH[4];

// Four times the levels in bits 2 and 3 of the bytes; two_bytes() makes kUnit of it.
HWY_INLINE VB level_bytes(VI word) {
  static_assert(kUnit == 4 * 256);
  return hn::BitCast(kB, hn::And(word, hn::Set(kI, 0x0c0c0c0c)));
}

HWY_INLINE VH mix(VH a, VH b, VH fraction) {
  return hn::Add(a, hn::MulFixedPoint15(hn::Sub(b, a), fraction));
}

// A fraction in 2^-15, rounded down, in both halves.
HWY_INLINE VH fixed_fraction(VF fraction) {
  const VI fixed = hn::ConvertTo(kI, hn::Mul(fraction, hn::Set(kF, 32768.0f)));
  return hn::BitCast(kH, hn::Or(fixed, hn::ShiftLeft<16>(fixed)));
}

// Between the eight corners, times kUnit * 2^16.
HWY_INLINE VF between_corners(const Corners& corners, VH fraction_x, VH fraction_y, VF fraction_z) {
  const VH both = mix(mix(corners[0], corners[1], fraction_y),
                      mix(corners[2], corners[3], fraction_y), fraction_x);
  const VI lanes = hn::BitCast(kI, both);
  const VF low = hn::ConvertTo(kF, hn::ShiftLeft<16>(lanes));
  const VF high = hn::ConvertTo(kF, hn::And(lanes, hn::Set(kI, ~0xffff)));
  return hn::Add(low, hn::Mul(fraction_z, hn::Sub(high, low)));
}

// phi (voxels) and its slope (per voxel).
HWY_INLINE void sample(const Planes& planes, const VF (&fraction)[3], VF& phi, VF (&slope)[3]) {
  VB sum_y[3][2], step_y[3][2];  // over and across the two rows at each corner's y
  for (int x = 0; x < 3; ++x) {
    const VI all = planes.words[x];
    const VB rows[3] = {level_bytes(hn::ShiftLeft<2>(all)), level_bytes(all),
                        level_bytes(hn::ShiftRight<2>(all))};
    for (int y = 0; y < 2; ++y) {
      sum_y[x][y] = hn::Add(rows[y], rows[y + 1]);
      step_y[x][y] = hn::Sub(rows[y + 1], rows[y]);
    }
  }
  Corners level, along[3];
  for (int x = 0; x < 2; ++x) {
    for (int y = 0; y < 2; ++y) {
      const VB column = hn::Add(sum_y[x][y], sum_y[x + 1][y]);
      const VB across_x = hn::Sub(sum_y[x + 1][y], sum_y[x][y]);
      const VB across_y = hn::Add(step_y[x][y], step_y[x + 1][y]);
      const VH below = two_bytes<0>(column), above = two_bytes<1>(column);
      level[2 * x + y] = hn::Add(below, above);
      along[2][2 * x + y] = hn::Sub(above, below);
      along[0][2 * x + y] = hn::Add(two_bytes<0>(across_x), two_bytes<1>(across_x));
      along[1][2 * x + y] = hn::Add(two_bytes<0>(across_y), two_bytes<1>(across_y));
    }
  }
  const VH fraction_x = fixed_fraction(fraction[0]), fraction_y = fixed_fraction(fraction[1]);
  constexpr float kScale = 1.0f / (65536.0f * kUnit);
  const VF per_level = hn::Set(kF, kScale / 8), per_step = hn::Set(kF, kScale / 4);
  phi = hn::Sub(hn::Mul(between_corners(level, fraction_x, fraction_y, fraction[2]), per_level),
                hn::Set(kF, 1.0f));
  for (int axis = 0; axis < 3; ++axis) {
    slope[axis] =
        hn::Mul(between_corners(along[axis], fraction_x, fraction_y, fraction[2]), per_step);
  }
}
#endif

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

// Results of the stages for the points of a chunk.
struct Stages {
  HWY_ALIGN std::int32_t words[3][kChunk];  // Planes
  HWY_ALIGN float phi[kChunk];
  HWY_ALIGN float slope[3][kChunk];
};

// ForceField::measure.
class Kernel : public FieldKernel<LevelBricks> {
 public:
  Kernel(const query::CollectedPoints& points, const LevelScale& scale, LevelBricks& bricks,
         FieldSamples& samples)
      : FieldKernel(points, bricks, samples), scale_(scale) {}

  HWY_INLINE void run() {
    for (std::size_t first = 0; first < points_.count; first += kChunk) {
      measure_chunk(first, std::min(kChunk, points_.count - first));
    }
  }

 private:
  HWY_INLINE void measure_chunk(std::size_t first, std::size_t count) {
    Stages& s = stages_;
    for (std::size_t i = 0; i < count; i += kLanes) gather(load(first + i), i);
    for (std::size_t i = 0; i < count; i += kLanes) {
      Planes planes;
      for (int x = 0; x < 3; ++x) planes.words[x] = hn::Load(kI, s.words[x] + i);
      VF phi, slope[3];
      sample(planes, load(first + i).fraction, phi, slope);
      hn::Store(phi, kF, s.phi + i);
      for (int axis = 0; axis < 3; ++axis) hn::Store(slope[axis], kF, s.slope[axis] + i);
    }
    for (std::size_t i = 0; i < count; i += kLanes) {
      VF slope[3];
      for (int axis = 0; axis < 3; ++axis) slope[axis] = hn::Load(kF, s.slope[axis] + i);
      push_lanes(first + i, hn::Load(kF, s.phi + i), slope);
    }
  }

  HWY_INLINE void push_lanes(std::size_t first, VF phi, const VF (&slope)[3]) {
    const Lanes lanes = load(first);
    VF u[3];
    push(phi, slope, lanes.normal, u);
    const VF one = hn::Set(kF, 1.0f), size_m = hn::Set(kF, scale_.voxel_size_m);
    const VF length = hn::Sqrt(dot(u, u));
    const auto directed = hn::Gt(length, hn::Set(kF, kTiny));
    const VF per_length = hn::Div(one, length);
    const VF strength = hn::Min(hn::Mul(length, hn::Set(kF, kWeak)), one);
    for (int axis = 0; axis < 3; ++axis) u[axis] = hn::Mul(u[axis], per_length);
    const VF steps = hn::Neg(hn::Add(phi, hn::Set(kF, scale_.b)));
    VF depth_m = hn::Mul(hn::Mul(steps, strength), size_m);
    depth_m = hn::Mul(depth_m, hn::Add(hn::Add(hn::Abs(u[0]), hn::Abs(u[1])), hn::Abs(u[2])));
    depth_m = hn::Add(depth_m, hn::Mul(hn::Mul(hn::Set(kF, scale_.a), strength), size_m));
    const VF nothing = hn::Neg(hn::Mul(hn::Max(phi, hn::Zero(kF)), size_m));
    depth_m = hn::IfThenElse(directed, depth_m, nothing);
    for (int n = 0; n < 3; ++n) u[n] = hn::IfThenElse(directed, u[n], lanes.normal[n]);
    store(first, depth_m, u, slope);
  }

  // The 27 levels around the points, to words[.][i] on.
  HWY_INLINE void gather(const Lanes& lanes, std::size_t i) {
    const VI(&voxel)[3] = lanes.voxel;
    const auto [slot, held] = find_bricks(voxel);
    // Shifts and sums rather than products, which are slow for this width.
    static_assert(LevelBricks::kBrickBytes == 960 && LevelBricks::kPlaneBytes == 96 &&
                  LevelBricks::kRowBytes == 12);
    const VI seven = hn::Set(kI, 7);
    const VI x = hn::And(voxel[0], seven), y = hn::And(voxel[1], seven);
    const VI at_brick = hn::Sub(hn::ShiftLeft<10>(slot), hn::ShiftLeft<6>(slot));
    const VI at_plane = hn::Add(hn::ShiftLeft<6>(x), hn::ShiftLeft<5>(x));
    const VI at_row = hn::Add(hn::ShiftLeft<3>(y), hn::ShiftLeft<2>(y));
    const VI in_brick = hn::Add(hn::Add(at_plane, at_row), hn::And(voxel[2], seven));
    const VI offset = hn::Add(at_brick, in_brick);
    for (std::uint32_t plane = 0; plane < 3; ++plane) {
      const auto* base = reinterpret_cast<const std::int32_t*>(bricks_.levels() +
                                                               plane * LevelBricks::kPlaneBytes);
      hn::Store(hn::GatherOffset(kI, base, offset), kI, stages_.words[plane] + i);
    }
    const auto missing = hn::AndNot(held, lanes.real);
    if (HWY_LIKELY(hn::AllFalse(kI, missing))) return;
    fetch(voxel, in_brick, missing, [&](std::size_t lane, const std::uint8_t* levels) {
      for (std::uint32_t plane = 0; plane < 3; ++plane) {
        hwy::CopyBytes<4>(levels + plane * LevelBricks::kPlaneBytes,
                          &stages_.words[plane][i + lane]);
      }
    });
  }

  LevelScale scale_;
  Stages stages_;
};

void measure_on_target(const query::CollectedPoints& points, const LevelScale& scale,
                       LevelBricks& bricks, FieldSamples& samples) {
  Kernel(points, scale, bricks, samples).run();
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer::field
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::field {

HWY_EXPORT(measure_on_target);

void LevelField::measure(const query::CollectedPoints& points,
                         FieldSamples& samples) const noexcept {
  HWY_DYNAMIC_DISPATCH(measure_on_target)(points, scale_, bricks_, samples);
}

}  // namespace forcelayer::field
#endif

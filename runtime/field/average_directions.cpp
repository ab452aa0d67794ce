// average_directions(), for as many contacts at a time as the machine's vectors hold.
#include "runtime/field/average_directions.h"

#include <algorithm>

// Compiles what follows once per instruction set.
#include "runtime/query/vector_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/field/average_directions.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::field {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, 16>;  // up to 16 values behind the last sample are read
using VF = hn::Vec<Floats>;
constexpr Floats kF;
constexpr std::size_t kLanes = HWY_MIN(HWY_LANES(float), 16);

constexpr std::size_t kBefore = 16, kWindow = 32;
constexpr float kWeak = 1e-3f;  // of a sum whose weights are of order one: no direction

// Contacts between the ends of the list are averaged so many at a time.
constexpr std::size_t kChunk = 128;
static_assert(kChunk % kLanes == 0 && kBefore % kLanes == 0);

// Columns by address: the compiler must assume that a store of floats can change the address inside
// a std::vector.
struct Averaging {
  Averaging(const query::CollectedPoints& points, const FieldSamples& samples, float voxel_size_m,
            float min_depth, ContactSet& set)
      : r{points.rx.data(), points.ry.data(), points.rz.data()},
        g{samples.gx.data(), samples.gy.data(), samples.gz.data()},
        own{samples.dx.data(), samples.dy.data(), samples.dz.data()},
        depth_m(set.depth_m.data()),
        direction{set.ux.data(), set.uy.data(), set.uz.data()},
        min_depth_m(min_depth) {
    const float radius_m = kNeighbourVoxels * voxel_size_m;
    per_radius2_1pm2 = 1.0f / (radius_m * radius_m);
  }

  const float *r[3], *g[3], *own[3];  // places, slopes and directions of the samples
  const float* depth_m;
  float* direction[3];  // to be set
  float min_depth_m, per_radius2_1pm2;
};

// Places and slopes of kLanes samples: all that their weights for each other depend on.
struct Place {
  VF r[3], g[3];
};

HWY_INLINE Place places_from(const Averaging& a, std::size_t i) {
  return {{hn::LoadU(kF, a.r[0] + i), hn::LoadU(kF, a.r[1] + i), hn::LoadU(kF, a.r[2] + i)},
          {hn::LoadU(kF, a.g[0] + i), hn::LoadU(kF, a.g[1] + i), hn::LoadU(kF, a.g[2] + i)}};
}

HWY_INLINE Place place_of(const Averaging& a, std::size_t i) {
  return {{hn::Set(kF, a.r[0][i]), hn::Set(kF, a.r[1][i]), hn::Set(kF, a.r[2][i])},
          {hn::Set(kF, a.g[0][i]), hn::Set(kF, a.g[1][i]), hn::Set(kF, a.g[2][i])}};
}

HWY_INLINE VF dot(const VF (&a)[3], const VF (&b)[3]) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}

// The same bits whichever of the two comes first.
HWY_INLINE VF weight_between(const Averaging& a, const Place& one, const Place& other) {
  VF d[3];
  for (int axis = 0; axis < 3; ++axis) d[axis] = hn::Sub(other.r[axis], one.r[axis]);
  const VF zero = hn::Zero(kF), per_radius2_1pm2 = hn::Set(kF, a.per_radius2_1pm2);
  const VF near = hn::Max(zero, hn::Sub(hn::Set(kF, 1.0f), hn::Mul(dot(d, d), per_radius2_1pm2)));
  const VF root = hn::Mul(near, hn::Max(zero, dot(other.g, one.g)));
  return hn::Mul(root, root);
}

HWY_INLINE void add_weighted(VF weight, const VF (&g)[3], VF (&sum)[3]) {
  for (int axis = 0; axis < 3; ++axis) {
    sum[axis] = hn::Add(sum[axis], hn::Mul(weight, g[axis]));
  }
}

HWY_INLINE VF length(const VF (&v)[3]) { return hn::Sqrt(dot(v, v)); }

// Sets the directions of the first `lanes` contacts from i on by the sums of their slopes.
HWY_INLINE void set_directions(const Averaging& a, std::size_t i, std::size_t lanes,
                               const VF (&slope)[3]) {
  const VF one = hn::Set(kF, 1.0f), weak = hn::Set(kF, kWeak);
  VF mixed[3] = {slope[0], slope[1], slope[2]}, rest = hn::Zero(kF);
  VF size = length(slope);
  const bool all_strong = hn::AllTrue(kF, hn::Ge(size, weak));
  if (!all_strong) {
    const VF fraction = hn::Min(one, hn::Div(size, weak));
    rest = hn::Mul(hn::Sub(one, fraction), weak);
    for (VF& axis : mixed) axis = hn::Mul(fraction, axis);
  }
  for (int axis = 0; axis < 3; ++axis) {
    mixed[axis] = hn::Add(mixed[axis], hn::Mul(rest, hn::LoadU(kF, a.own[axis] + i)));
  }
  if (!all_strong) size = length(mixed);
  const auto deep = hn::Gt(hn::LoadU(kF, a.depth_m + i), hn::Set(kF, a.min_depth_m));
  const auto meant = hn::And(hn::And(deep, hn::Gt(size, hn::Zero(kF))), hn::FirstN(kF, lanes));
  for (int axis = 0; axis < 3; ++axis) {
    float* to = a.direction[axis] + i;
    hn::StoreU(hn::IfThenElse(meant, hn::Div(mixed[axis], size), hn::LoadU(kF, to)), kF, to);
  }
}

// Contacts [begin, end), all over the `window` samples from `first` on.
HWY_INLINE void average_over(const Averaging& a, std::size_t begin, std::size_t end,
                             std::size_t first, std::size_t window) {
  for (std::size_t i = begin; i < end; i += kLanes) {
    const Place own = places_from(a, i);
    VF sum[3] = {hn::Zero(kF), hn::Zero(kF), hn::Zero(kF)};
    for (std::size_t k = 0; k < window; ++k) {
      const Place other = place_of(a, first + k);
      add_weighted(weight_between(a, own, other), other.g, sum);
    }
    set_directions(a, i, end - i, sum);
  }
}

// Contacts [begin, end), each over its own window, which no end of the list cuts. Two samples have
// the same weight for each other: it is computed once, for the first of them.
HWY_INLINE void average_around(const Averaging& a, std::size_t begin, std::size_t end) {
  // [o][n]: of samples `from` + n and `from` + n + o
  HWY_ALIGN float weight[kBefore + 1][kBefore + kChunk];
  const std::size_t from = begin - kBefore, samples = end - from;
  for (std::size_t n = 0; n < samples; n += kLanes) {
    const Place own = places_from(a, from + n);
    for (std::size_t o = 0; o <= kBefore; ++o) {
      const Place other = places_from(a, from + n + o);
      hn::Store(weight_between(a, own, other), kF, &weight[o][n]);
    }
  }
  const auto add = [&a](const float* weights, std::size_t i, VF(&sum)[3]) HWY_ATTR {
    const VF g[3] = {hn::LoadU(kF, a.g[0] + i), hn::LoadU(kF, a.g[1] + i),
                     hn::LoadU(kF, a.g[2] + i)};
    add_weighted(hn::LoadU(kF, weights), g, sum);
  };
  for (std::size_t n = kBefore; n < samples; n += kLanes) {
    VF sum[3] = {hn::Zero(kF), hn::Zero(kF), hn::Zero(kF)};
    for (std::size_t o = kBefore; o > 0; --o) add(&weight[o][n - o], from + n - o, sum);
    for (std::size_t o = 0; o < kWindow - kBefore; ++o) add(&weight[o][n], from + n + o, sum);
    set_directions(a, from + n, samples - n, sum);
  }
}

void average_on_target(const query::CollectedPoints& points, const FieldSamples& samples,
                       float voxel_size_m, float min_depth_m, ContactSet& set) {
  const Averaging a(points, samples, voxel_size_m, min_depth_m, set);
  const std::size_t count = set.count;
  if (count <= kWindow) {
    average_over(a, 0, count, 0, count);
    return;
  }
  average_over(a, 0, kBefore, 0, kWindow);
  const std::size_t last = count - kWindow;  // first sample of the last window
  for (std::size_t i = 0; i < last; i += kChunk) {
    average_around(a, kBefore + i, kBefore + std::min(last, i + kChunk));
  }
  average_over(a, kBefore + last, count, last, kWindow);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer::field
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::field {

HWY_EXPORT(average_on_target);

void average_directions(const query::CollectedPoints& points, const FieldSamples& samples,
                        float voxel_size_m, float min_depth_m, ContactSet& set) noexcept {
  HWY_DYNAMIC_DISPATCH(average_on_target)(points, samples, voxel_size_m, min_depth_m, set);
}

}  // namespace forcelayer::field
#endif

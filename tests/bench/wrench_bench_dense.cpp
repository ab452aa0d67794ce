#include "tests/bench/wrench_bench_dense.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <stdexcept>

// Compiles what follows once per instruction set.
#include "runtime/query/vector_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tests/bench/wrench_bench_dense.cpp"
#include <hwy/foreach_target.h>
// Behind foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::bench {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Floats = hn::ScalableTag<float>;
using Ints = hn::RebindToSigned<Floats>;
using VF = hn::Vec<Floats>;
using VI = hn::Vec<Ints>;
constexpr Floats kF;
constexpr Ints kI;

HWY_INLINE VF mix(VF a, VF b, VF share) { return hn::MulAdd(share, hn::Sub(b, a), a); }

// Between four numbers that lie a stride apart each way.
HWY_INLINE VF between_four(const float* cells, VI at, std::int32_t stride_a, std::int32_t stride_b,
                           VF share_a, VF share_b) {
  const VF low =
      mix(hn::GatherIndex(kF, cells, at), hn::GatherIndex(kF, cells + stride_b, at), share_b);
  const VF high = mix(hn::GatherIndex(kF, cells + stride_a, at),
                      hn::GatherIndex(kF, cells + stride_a + stride_b, at), share_b);
  return mix(low, high, share_a);
}

// kWide: the slope of distance_field.h, which reads the centers beside the cell too, and its push
// up to a depth of 1.5 voxels. The lists have room for whole vectors beyond their end, as those of
// the runtime's fields do.
template <bool kWide>
HWY_INLINE void measure_at(const query::CollectedPoints& points, const DenseDistances& box,
                           const std::array<std::int32_t, 3>& first, float voxel_size_m,
                           float offset_m, field::FieldSamples& out) {
  constexpr std::int32_t kBeside = kWide ? 1 : 0;
  const std::int32_t* voxel[3] = {points.vx.data(), points.vy.data(), points.vz.data()};
  const float* fraction[3] = {points.fx.data(), points.fy.data(), points.fz.data()};
  const std::int32_t stride[3] = {box.dims[1] * box.dims[2], box.dims[2], 1};
  const VF half = hn::Set(kF, 0.5f), one = hn::Set(kF, 1.0f);
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(kF)) {
    VF share[3];
    VI at = hn::Zero(kI);
    auto inside = hn::FirstN(kI, points.count - i);
    for (int n = 0; n < 3; ++n) {
      const VF f = hn::LoadU(kF, fraction[n] + i);
      const auto before = hn::Lt(f, half);
      share[n] = hn::Sub(hn::IfThenElse(before, hn::Add(f, one), f), half);
      const VI cell = hn::Sub(hn::Sub(hn::LoadU(kI, voxel[n] + i), hn::Set(kI, first[n])),
                              hn::IfThenElseZero(hn::RebindMask(kI, before), hn::Set(kI, 1)));
      inside = hn::AndNot(hn::Lt(cell, hn::Set(kI, kBeside)), inside);
      inside = hn::And(inside, hn::Lt(cell, hn::Set(kI, box.dims[n] - 1 - kBeside)));
      at = hn::Add(at, hn::Mul(cell, hn::Set(kI, stride[n])));
    }
    at = hn::IfThenElseZero(inside, at);
    const float* cells = box.distance_m.data();
    VF at_x[2], step_y[2], step_z[2];
    for (int x = 0; x < 2; ++x) {
      const float* plane = cells + x * stride[0];
      const VF a0 = hn::GatherIndex(kF, plane, at), a1 = hn::GatherIndex(kF, plane + 1, at);
      const VF b0 = hn::GatherIndex(kF, plane + stride[1], at);
      const VF b1 = hn::GatherIndex(kF, plane + stride[1] + 1, at);
      const VF a = mix(a0, a1, share[2]), b = mix(b0, b1, share[2]);
      step_y[x] = hn::Sub(b, a);
      step_z[x] = mix(hn::Sub(a1, a0), hn::Sub(b1, b0), share[1]);
      at_x[x] = mix(a, b, share[1]);
    }
    const VF distance = mix(at_x[0], at_x[1], share[0]);
    VF slope[3] = {hn::Sub(at_x[1], at_x[0]), mix(step_y[0], step_y[1], share[0]),
                   mix(step_z[0], step_z[1], share[0])};
    if constexpr (kWide) {
      for (int n = 0; n < 3; ++n) {
        const auto before = hn::RebindMask(kI, hn::Lt(share[n], half));
        const VI aside =
            hn::IfThenElse(before, hn::Set(kI, -stride[n]), hn::Set(kI, 2 * stride[n]));
        const VI there = hn::IfThenElseZero(inside, hn::Add(at, aside));
        const int a = (n + 1) % 3, b = (n + 2) % 3;
        const VF beside = between_four(cells, there, stride[a], stride[b], share[a], share[b]);
        const VF x = hn::Sub(share[n], half), size = hn::Abs(x);
        const VF kept = hn::MulAdd(hn::Sub(size, hn::Set(kF, 1.5f)), size, one);
        slope[n] = hn::MulAdd(kept, slope[n], hn::Mul(x, hn::Sub(beside, distance)));
      }
    }
    const VF square =
        hn::MulAdd(slope[0], slope[0], hn::MulAdd(slope[1], slope[1], hn::Mul(slope[2], slope[2])));
    const auto directed = hn::And(hn::RebindMask(kF, inside), hn::Gt(square, hn::Zero(kF)));
    const VF per_length = hn::Div(one, hn::Sqrt(square));
    VF depth = hn::Sub(hn::Set(kF, offset_m), distance);
    if constexpr (kWide) {
      const VF size_m = hn::Set(kF, voxel_size_m);
      const VF certain = hn::Min(
          hn::Mul(hn::Sqrt(square), hn::Set(kF, 1 / (field::kLeastSlope * voxel_size_m))), one);
      const VF beyond = hn::Mul(hn::Max(hn::Sub(depth, size_m), hn::Zero(kF)), certain);
      depth = hn::Mul(hn::Add(hn::Min(depth, size_m), beyond), certain);
    }
    hn::StoreU(hn::IfThenElse(directed, depth, hn::Neg(one)), kF, &out.depth_m[i]);
    hn::StoreU(hn::Mul(slope[0], per_length), kF, &out.dx[i]);
    hn::StoreU(hn::Mul(slope[1], per_length), kF, &out.dy[i]);
    hn::StoreU(hn::Mul(slope[2], per_length), kF, &out.dz[i]);
    const VF per_voxel = hn::Set(kF, 1 / voxel_size_m);
    hn::StoreU(hn::Mul(slope[0], per_voxel), kF, &out.gx[i]);
    hn::StoreU(hn::Mul(slope[1], per_voxel), kF, &out.gy[i]);
    hn::StoreU(hn::Mul(slope[2], per_voxel), kF, &out.gz[i]);
  }
}

void measure_dense(const query::CollectedPoints& points, const DenseDistances& box,
                   const std::array<std::int32_t, 3>& first, float voxel_size_m, float offset_m,
                   field::FieldSamples& out) {
  measure_at<false>(points, box, first, voxel_size_m, offset_m, out);
}

void measure_wide(const query::CollectedPoints& points, const DenseDistances& box,
                  const std::array<std::int32_t, 3>& first, float voxel_size_m, float offset_m,
                  field::FieldSamples& out) {
  measure_at<true>(points, box, first, voxel_size_m, offset_m, out);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::bench {

HWY_EXPORT(measure_dense);
HWY_EXPORT(measure_wide);

DenseField::DenseField(const Voxmap& voxmap, const DenseDistances& distances, double offset_m,
                       DenseSlope slope)
    : distances_(distances),
      voxel_size_m_(static_cast<float>(voxmap.voxel_size_m())),
      offset_m_(static_cast<float>(offset_m)),
      slope_(slope) {
  for (std::size_t d = 0; d < 3; ++d) {
    first_[d] = static_cast<std::int32_t>(distances.low[d] - voxmap.header().directory_origin[d]);
  }
}

void DenseField::measure(const query::CollectedPoints& points,
                         field::FieldSamples& samples) const noexcept {
  if (slope_ == DenseSlope::kContinuous) {
    HWY_DYNAMIC_DISPATCH(measure_wide)
    (points, distances_, first_, voxel_size_m_, offset_m_, samples);
  } else {
    HWY_DYNAMIC_DISPATCH(measure_dense)
    (points, distances_, first_, voxel_size_m_, offset_m_, samples);
  }
}

namespace {

// The distance between the eight centers around a place in units of voxels from the first center,
// and its slope, m a voxel: the gradient, or that of distance_field.h.
struct Plain {
  double distance_m;
  glm::dvec3 slope_m;
};

double between_centers(const DenseDistances& box, const glm::ivec3& cell, const glm::dvec3& share) {
  double sum = 0;
  for (int n = 0; n < 8; ++n) {
    const glm::ivec3 corner(n >> 2, n >> 1 & 1, n & 1);
    double weight = 1;
    for (int axis = 0; axis < 3; ++axis) {
      weight *= corner[axis] != 0 ? share[axis] : 1 - share[axis];
    }
    if (weight == 0) continue;  // a center that counts nothing may lie outside
    const glm::ivec3 at = cell + corner;
    sum +=
        weight *
        double{
            box.distance_m[box.index({box.low[0] + at.x, box.low[1] + at.y, box.low[2] + at.z})]};
  }
  return sum;
}

Plain plain_at(const DenseDistances& box, const glm::dvec3& place, bool wide) {
  const glm::ivec3 cell(glm::floor(place));
  const glm::dvec3 share = place - glm::dvec3(cell);
  Plain plain{between_centers(box, cell, share), {}};
  for (int axis = 0; axis < 3; ++axis) {
    const auto on =
        [&](int steps) {  // the face of the cell so many steps on, at the place's height
          glm::dvec3 on_face = share;
          on_face[axis] = 0;
          glm::ivec3 from = cell;
          from[axis] += steps;
          return between_centers(box, from, on_face);
        };
    const double step = on(1) - on(0), a = share[axis] - 0.5;
    plain.slope_m[axis] = step;
    if (!wide) continue;
    const double beside = a < 0 ? on(-1) : on(2);
    plain.slope_m[axis] = (1 - 1.5 * std::abs(a) + a * a) * step + a * (beside - plain.distance_m);
  }
  return plain;
}

}  // namespace

void DenseField::check(std::size_t places, std::mt19937_64& random) const {
  query::CollectedPoints points;
  field::FieldSamples samples;
  points.reserve(places), samples.reserve(places);
  points.count = static_cast<std::uint32_t>(places);
  const bool wide = slope_ == DenseSlope::kContinuous;
  std::vector<glm::dvec3> at;
  std::int32_t* const voxel[3] = {points.vx.data(), points.vy.data(), points.vz.data()};
  float* const fraction[3] = {points.fx.data(), points.fy.data(), points.fz.data()};
  for (std::size_t i = 0; i < places; ++i) {
    glm::dvec3 place;
    for (int axis = 0; axis < 3; ++axis) {
      std::uniform_int_distribution<std::int32_t> some(2, distances_.dims[axis] - 4);
      std::uniform_real_distribution<float> part(0, 1);
      const std::int32_t v = some(random);
      const float f = std::min(part(random), 0.999999f);
      voxel[axis][i] = first_[axis] + v, fraction[axis][i] = f;
      place[axis] = v + double{f} - 0.5;
    }
    at.push_back(place);
  }
  measure(points, samples);
  for (std::size_t i = 0; i < places; ++i) {
    const Plain plain = plain_at(distances_, at[i], wide);
    const double steepness = glm::length(plain.slope_m) / double{voxel_size_m_};
    if (steepness < 1e-3) continue;  // no direction to compare
    double depth_m = double{offset_m_} - plain.distance_m;
    if (wide) {
      const double certain = std::min(1.0, steepness / double{field::kLeastSlope});
      const double s = double{voxel_size_m_};
      depth_m = certain * (std::min(depth_m, s) + std::max(0.0, depth_m - s) * certain);
    }
    const glm::dvec3 direction(samples.dx[i], samples.dy[i], samples.dz[i]);
    const double depth_off_m = std::abs(depth_m - double{samples.depth_m[i]});
    const double direction_off = glm::distance(direction, glm::normalize(plain.slope_m));
    // Rounding to single precision, of distances and of their differences, grows with the distance.
    const double s = double{voxel_size_m_};
    const double rounding = 1e-5 * std::max(10.0, std::abs(plain.distance_m) / s);
    if (depth_off_m > rounding * s || direction_off * steepness > rounding) {
      throw std::runtime_error("the dense field's vectors give another force than its formulas");
    }
  }
}

}  // namespace forcelayer::bench
#endif

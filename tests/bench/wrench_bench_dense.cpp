#include "tests/bench/wrench_bench_dense.h"

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

HWY_INLINE VF mix(VF a, VF b, VF between) { return hn::MulAdd(between, hn::Sub(b, a), a); }

// The lists have room for whole vectors beyond their end, as those of the runtime's fields do.
void measure_dense(const query::CollectedPoints& points, const DenseDistances& box,
                   const std::array<std::int32_t, 3>& first, float voxel_size_m, float offset_m,
                   field::FieldSamples& out) {
  const std::int32_t* voxel[3] = {points.vx.data(), points.vy.data(), points.vz.data()};
  const float* fraction[3] = {points.fx.data(), points.fy.data(), points.fz.data()};
  const std::int32_t stride[3] = {box.dims[1] * box.dims[2], box.dims[2], 1};
  const VF half = hn::Set(kF, 0.5f), one = hn::Set(kF, 1.0f);
  for (std::size_t i = 0; i < points.count; i += hn::Lanes(kF)) {
    VF between[3];
    VI at = hn::Zero(kI);
    auto inside = hn::FirstN(kI, points.count - i);
    for (int n = 0; n < 3; ++n) {
      const VF f = hn::LoadU(kF, fraction[n] + i);
      const auto before = hn::Lt(f, half);
      between[n] = hn::Sub(hn::IfThenElse(before, hn::Add(f, one), f), half);
      const VI cell = hn::Sub(hn::Sub(hn::LoadU(kI, voxel[n] + i), hn::Set(kI, first[n])),
                              hn::IfThenElseZero(hn::RebindMask(kI, before), hn::Set(kI, 1)));
      inside = hn::AndNot(hn::Lt(cell, hn::Zero(kI)), inside);
      inside = hn::And(inside, hn::Lt(cell, hn::Set(kI, box.dims[n] - 1)));
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
      const VF a = mix(a0, a1, between[2]), b = mix(b0, b1, between[2]);
      step_y[x] = hn::Sub(b, a);
      step_z[x] = mix(hn::Sub(a1, a0), hn::Sub(b1, b0), between[1]);
      at_x[x] = mix(a, b, between[1]);
    }
    const VF distance = mix(at_x[0], at_x[1], between[0]);
    const VF slope[3] = {hn::Sub(at_x[1], at_x[0]), mix(step_y[0], step_y[1], between[0]),
                         mix(step_z[0], step_z[1], between[0])};
    const VF square =
        hn::MulAdd(slope[0], slope[0], hn::MulAdd(slope[1], slope[1], hn::Mul(slope[2], slope[2])));
    const auto directed = hn::And(hn::RebindMask(kF, inside), hn::Gt(square, hn::Zero(kF)));
    const VF per_length = hn::Div(one, hn::Sqrt(square));
    const VF depth = hn::Sub(hn::Set(kF, offset_m), distance);
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

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer::bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::bench {

HWY_EXPORT(measure_dense);

DenseField::DenseField(const Voxmap& voxmap, const DenseDistances& distances, double offset_m)
    : distances_(distances),
      voxel_size_m_(static_cast<float>(voxmap.voxel_size_m())),
      offset_m_(static_cast<float>(offset_m)) {
  for (std::size_t d = 0; d < 3; ++d) {
    first_[d] = static_cast<std::int32_t>(distances.low[d] - voxmap.header().directory_origin[d]);
  }
}

void DenseField::measure(const query::CollectedPoints& points,
                         field::FieldSamples& samples) const noexcept {
  HWY_DYNAMIC_DISPATCH(measure_dense)
  (points, distances_, first_, voxel_size_m_, offset_m_, samples);
}

}  // namespace forcelayer::bench
#endif

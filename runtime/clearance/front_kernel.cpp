#include "runtime/clearance/front_kernel.h"

#include "runtime/query/vector_targets.h"
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/clearance/front_kernel.cpp"
#include <hwy/foreach_target.h>
// Behind foreach_target.h, as Highway wants it.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace forcelayer::clearance {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

float MinSum(const FrontColumns& front, float x, float y, float z, float best) {
  const hn::CappedTag<float, 16> f;
  const auto px = hn::Set(f, x), py = hn::Set(f, y), pz = hn::Set(f, z);
  auto smallest = hn::Set(f, best);
  for (std::size_t i = 0; i < front.count; i += hn::Lanes(f)) {
    const auto dx = hn::Sub(hn::LoadU(f, front.x + i), px);
    const auto dy = hn::Sub(hn::LoadU(f, front.y + i), py);
    const auto dz = hn::Sub(hn::LoadU(f, front.z + i), pz);
    const auto squared = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
    smallest = hn::Min(smallest, hn::Add(hn::Sqrt(squared), hn::LoadU(f, front.smallest + i)));
  }
  return hn::GetLane(hn::MinOfLanes(f, smallest));
}

}  // namespace HWY_NAMESPACE
}  // namespace forcelayer::clearance
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer::clearance {

HWY_EXPORT(MinSum);

float min_sum(const FrontColumns& front, float x, float y, float z, float best) noexcept {
  return HWY_DYNAMIC_DISPATCH(MinSum)(front, x, y, z, best);
}

}  // namespace forcelayer::clearance
#endif

#include "runtime/surface_directions.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

// Vectors stand in arrays here, which those of unknown size cannot.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "runtime/surface_directions.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace forcelayer {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::ScalableTag<float>;
using VF = hn::Vec<Floats>;
constexpr Floats kF;
constexpr std::uint32_t kLanes = HWY_LANES(float);

// Neighbours are summed in 16 columns, and the columns in halves, whatever the width.
constexpr std::uint32_t kColumns = 16, kWindow = 2 * kColumns;
constexpr std::uint32_t kVectors = kColumns / kLanes;

float sum_of_columns(const float* columns) {
  float half[8];
  for (int i = 0; i < 8; ++i) half[i] = columns[i] + columns[i + 8];
  for (int i = 0; i < 4; ++i) half[i] += half[i + 4];
  return (half[0] + half[2]) + (half[1] + half[3]);
}

// Sum of the weighted slopes around sample i.
glm::vec3 slope_around(const CollectedPoints& points, const FieldSamples& samples, std::uint32_t i,
                       float per_radius2_1pm2) {
  const std::uint32_t last = samples.count > kWindow ? samples.count - kWindow : 0;
  const std::uint32_t first = std::min(i > kColumns ? i - kColumns : 0, last);
  const VF x = hn::Set(kF, points.rx[i]), y = hn::Set(kF, points.ry[i]),
           z = hn::Set(kF, points.rz[i]);
  const VF gx = hn::Set(kF, samples.gx[i]), gy = hn::Set(kF, samples.gy[i]),
           gz = hn::Set(kF, samples.gz[i]);
  const VF one = hn::Set(kF, 1.0f), zero = hn::Zero(kF);
  HWY_ALIGN float columns[3][kColumns];
  for (std::uint32_t v = 0; v < kVectors; ++v) {
    VF sum[3] = {zero, zero, zero};
    for (std::uint32_t block = 0; block < 2; ++block) {
      const std::uint32_t at = first + block * kColumns + v * kLanes;
      const VF dx = hn::Sub(hn::LoadU(kF, &points.rx[at]), x),
               dy = hn::Sub(hn::LoadU(kF, &points.ry[at]), y),
               dz = hn::Sub(hn::LoadU(kF, &points.rz[at]), z);
      const VF g[3] = {hn::LoadU(kF, &samples.gx[at]), hn::LoadU(kF, &samples.gy[at]),
                       hn::LoadU(kF, &samples.gz[at])};
      const VF r2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
      const VF near = hn::Max(zero, hn::Sub(one, hn::Mul(r2, hn::Set(kF, per_radius2_1pm2))));
      const VF alike =
          hn::Max(zero, hn::Add(hn::Add(hn::Mul(g[0], gx), hn::Mul(g[1], gy)), hn::Mul(g[2], gz)));
      const VF root = hn::Mul(near, alike);
      VF weight = hn::Mul(root, root);
      if (at + kLanes > samples.count) {
        const std::uint32_t left = samples.count > at ? samples.count - at : 0;
        weight = hn::IfThenElseZero(hn::FirstN(kF, left), weight);
      }
      for (int axis = 0; axis < 3; ++axis) {
        // Beyond the last sample stands anything, which no weight of zero may meet.
        const VF slope = at + kLanes > samples.count
                             ? hn::IfThenElseZero(hn::Gt(weight, zero), g[axis])
                             : g[axis];
        sum[axis] = hn::Add(sum[axis], hn::Mul(weight, slope));
      }
    }
    for (int axis = 0; axis < 3; ++axis) hn::Store(sum[axis], kF, &columns[axis][v * kLanes]);
  }
  glm::vec3 total;
  for (int axis = 0; axis < 3; ++axis) total[axis] = sum_of_columns(columns[axis]);
  return total;
}

void average_on_target(const CollectedPoints& points, const FieldSamples& samples,
                       float voxel_size_m, float least_depth_m, ContactSet& set) {
  constexpr float kWeak = 1e-3f;  // of a sum whose weights are of order one: no direction
  const float radius_m = kNeighbourVoxels * voxel_size_m;
  const float per_radius2_1pm2 = 1.0f / (radius_m * radius_m);
  for (std::uint32_t i = 0; i < set.count; ++i) {
    Contact& contact = set.contacts[i];
    if (!(contact.depth_m > least_depth_m)) continue;
    const glm::vec3 slope = slope_around(points, samples, i, per_radius2_1pm2);
    const float length = glm::length(slope);
    const float share = std::min(1.0f, length / kWeak);
    const glm::vec3 mixed = share * slope + (1.0f - share) * kWeak * contact.direction;
    const float size = glm::length(mixed);
    if (size > 0.0f) contact.direction = mixed / size;
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace forcelayer
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace forcelayer {

HWY_EXPORT(average_on_target);

void average_directions(const CollectedPoints& points, const FieldSamples& samples,
                        float voxel_size_m, float least_depth_m, ContactSet& set) noexcept {
  HWY_DYNAMIC_DISPATCH(average_on_target)(points, samples, voxel_size_m, least_depth_m, set);
}

}  // namespace forcelayer
#endif

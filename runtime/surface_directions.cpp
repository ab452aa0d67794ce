#include "runtime/surface_directions.h"

#include <algorithm>
#include <type_traits>

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

using Floats = hn::CappedTag<float, 16>;  // up to 16 values behind the last sample are read
using VF = hn::Vec<Floats>;
constexpr Floats kF;
constexpr std::uint32_t kLanes = HWY_MIN(HWY_LANES(float), 16);

constexpr std::uint32_t kBefore = 16, kWindow = 32;
constexpr float kWeak = 1e-3f;  // of a sum whose weights are of order one: no direction

// Contacts are averaged kLanes at a time, each lane adding up its samples one after the other. At
// the ends of the list all lanes have the same window, elsewhere each has its own.
struct OneWindow {
  std::uint32_t first;
  HWY_INLINE VF at(const std::vector<float>& values, std::uint32_t k) const {
    return hn::Set(kF, values[first + k]);
  }
};
struct OwnWindows {
  std::uint32_t first;  // of lane 0
  HWY_INLINE VF at(const std::vector<float>& values, std::uint32_t k) const {
    return hn::LoadU(kF, values.data() + first + k);
  }
};

struct Averaging {
  const CollectedPoints& points;
  const FieldSamples& samples;
  float per_radius2_1pm2;
  float least_depth_m;
  ContactSet& set;
};

// Sum of the weighted slopes around the samples from i on.
template <typename Windows>
HWY_INLINE void slopes_around(const Averaging& a, std::uint32_t i, const Windows& windows,
                              std::uint32_t window, VF (&sum)[3]) {
  const CollectedPoints& p = a.points;
  const FieldSamples& s = a.samples;
  const VF x = hn::LoadU(kF, &p.rx[i]), y = hn::LoadU(kF, &p.ry[i]), z = hn::LoadU(kF, &p.rz[i]);
  const VF gx = hn::LoadU(kF, &s.gx[i]), gy = hn::LoadU(kF, &s.gy[i]), gz = hn::LoadU(kF, &s.gz[i]);
  const VF one = hn::Set(kF, 1.0f), zero = hn::Zero(kF);
  const VF per_radius2_1pm2 = hn::Set(kF, a.per_radius2_1pm2);
  for (VF& axis : sum) axis = zero;
  for (std::uint32_t k = 0; k < window; ++k) {
    const VF dx = hn::Sub(windows.at(p.rx, k), x), dy = hn::Sub(windows.at(p.ry, k), y),
             dz = hn::Sub(windows.at(p.rz, k), z);
    const VF g[3] = {windows.at(s.gx, k), windows.at(s.gy, k), windows.at(s.gz, k)};
    const VF r2 = hn::Add(hn::Add(hn::Mul(dx, dx), hn::Mul(dy, dy)), hn::Mul(dz, dz));
    const VF near = hn::Max(zero, hn::Sub(one, hn::Mul(r2, per_radius2_1pm2)));
    const VF alike =
        hn::Max(zero, hn::Add(hn::Add(hn::Mul(g[0], gx), hn::Mul(g[1], gy)), hn::Mul(g[2], gz)));
    const VF root = hn::Mul(near, alike);
    const VF weight = hn::Mul(root, root);
    for (int axis = 0; axis < 3; ++axis) {
      sum[axis] = hn::Add(sum[axis], hn::Mul(weight, g[axis]));
    }
  }
}

HWY_INLINE VF length(const VF (&v)[3]) {
  return hn::Sqrt(hn::Add(hn::Add(hn::Mul(v[0], v[0]), hn::Mul(v[1], v[1])), hn::Mul(v[2], v[2])));
}

// Directions of the contacts [begin, end). Lanes beyond read what stands behind them, and are left
// out.
template <typename Windows>
HWY_INLINE void average(const Averaging& a, std::uint32_t begin, std::uint32_t end, Windows windows,
                        std::uint32_t window) {
  const FieldSamples& s = a.samples;
  const VF one = hn::Set(kF, 1.0f), weak = hn::Set(kF, kWeak);
  for (std::uint32_t i = begin; i < end; i += kLanes) {
    VF slope[3];
    slopes_around(a, i, windows, window, slope);
    if constexpr (std::is_same_v<Windows, OwnWindows>) windows.first += kLanes;
    const VF share = hn::Min(one, hn::Div(length(slope), weak));
    const VF rest = hn::Mul(hn::Sub(one, share), weak);
    VF mixed[3] = {hn::LoadU(kF, &s.dx[i]), hn::LoadU(kF, &s.dy[i]), hn::LoadU(kF, &s.dz[i])};
    for (int axis = 0; axis < 3; ++axis) {
      mixed[axis] = hn::Add(hn::Mul(share, slope[axis]), hn::Mul(rest, mixed[axis]));
    }
    const VF size = length(mixed);
    HWY_ALIGN float direction[3][kLanes], sizes[kLanes];
    hn::Store(size, kF, sizes);
    for (int axis = 0; axis < 3; ++axis) hn::Store(hn::Div(mixed[axis], size), kF, direction[axis]);
    const std::uint32_t lanes = std::min(kLanes, end - i);
    for (std::uint32_t lane = 0; lane < lanes; ++lane) {
      Contact& contact = a.set.contacts[i + lane];
      if (!(contact.depth_m > a.least_depth_m) || !(sizes[lane] > 0.0f)) continue;
      contact.direction = {direction[0][lane], direction[1][lane], direction[2][lane]};
    }
  }
}

void average_on_target(const CollectedPoints& points, const FieldSamples& samples,
                       float voxel_size_m, float least_depth_m, ContactSet& set) {
  const float radius_m = kNeighbourVoxels * voxel_size_m;
  const Averaging a{points, samples, 1.0f / (radius_m * radius_m), least_depth_m, set};
  const std::uint32_t count = set.count;
  if (count <= kWindow) {
    average(a, 0, count, OneWindow{0}, count);
    return;
  }
  const std::uint32_t last = count - kWindow;  // first sample of the last window
  average(a, 0, kBefore, OneWindow{0}, kWindow);
  average(a, kBefore, kBefore + last, OwnWindows{0}, kWindow);
  average(a, kBefore + last, count, OneWindow{last}, kWindow);
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

#include "voxelize/limits/region.h"

#include <algorithm>
#include <cmath>

#include "formats/voxmap_format.h"

namespace forcelayer::limits {
namespace {

// The voxels that [low_m, high_m) touches along one axis, clamped to the lattice.
struct Interval {
  std::int64_t low, high;
};
Interval touched(double low_m, double high_m, double voxel_size_m) {
  constexpr auto kLimit = static_cast<double>(kMaxVoxelIndex);
  const auto index = [&](double x) {
    return static_cast<std::int64_t>(std::clamp(x, -kLimit, kLimit - 1));
  };
  const std::int64_t low = index(std::floor(low_m / voxel_size_m));
  return {low, std::max(low, index(std::ceil(high_m / voxel_size_m) - 1))};
}

}  // namespace

Region region_of(const masks::VoxelBox& scene, const std::optional<std::array<double, 6>>& roi_m,
                 double voxel_size_m) {
  Region region;
  region.box = scene;
  if (!roi_m) return region;
  for (std::size_t d = 0; d < 3; ++d) {
    const Interval interval = touched((*roi_m)[d], (*roi_m)[d + 3], voxel_size_m);
    if (scene.low[d] < interval.low) {
      region.box.low[d] = interval.low;
      region.cropped_sides |= 1u << (2 * d);
    }
    if (scene.high[d] > interval.high) {
      region.box.high[d] = interval.high;
      region.cropped_sides |= 2u << (2 * d);
    }
    // Beside the scene: the one layer of the region next to the scene.
    if (interval.low > scene.high[d]) region.box.high[d] = interval.low;
    if (interval.high < scene.low[d]) region.box.low[d] = interval.high;
  }
  return region;
}

}  // namespace forcelayer::limits

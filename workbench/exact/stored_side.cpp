#include "workbench/exact/stored_side.h"

#include <array>
#include <cstdint>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "runtime/voxcheck/exact_exchange.h"

namespace forcelayer::exact {

bool StoredSide::is_inside(const Pose& world_from_center, double distance_m, double margin_m,
                           const std::function<bool(const glm::dvec3&)>& counts) const {
  if (!(distance_m < voxcheck::kNothingM)) return false;
  const double s = voxmap_.voxel_size_m();
  const KnownBox known = known_box(voxmap_.header());
  const PshellView& v = shell_.view();
  for (std::uint64_t n = 0; n < v.point_count; ++n) {
    const glm::dvec3 place_m = world_from_center.position_m +
                               world_from_center.orientation * glm::dvec3(v.x[n], v.y[n], v.z[n]);
    const glm::dvec3 low = glm::floor(place_m / s);
    std::array<std::int64_t, 3> voxel{};
    bool is_known = true;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double index = low[static_cast<int>(axis)];
      is_known = is_known && index >= static_cast<double>(known.low[axis]) &&
                 index < static_cast<double>(known.high[axis]);
      if (is_known) voxel[axis] = static_cast<std::int64_t>(index);
    }
    if (!is_known) continue;
    const auto [i, j, k] = voxel;
    const double off_m = glm::length(place_m - s * (low + 0.5)) + margin_m;  // its center
    const bool can_be_outside = voxmap_.max_distance_m(i, j, k) + off_m >= distance_m;
    const bool can_be_inside = voxmap_.min_distance_m(i, j, k) - off_m <= -distance_m;
    if (can_be_inside && !can_be_outside && counts(place_m)) return true;
  }
  return false;
}

}  // namespace forcelayer::exact

#include "runtime/guard/point_rule.h"

#include <cmath>
#include <limits>

#include "formats/guard.h"

namespace forcelayer::guard {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The nearest float that is not below, or not above, a number.
float rounded_up(double value) {
  const auto nearest = static_cast<float>(value);
  return double{nearest} < value ? std::nextafter(nearest, kInfinity) : nearest;
}
float rounded_down(double value) { return -rounded_up(-value); }

}  // namespace

PointRule::PointRule(const VoxmapHeader& header, bool proves_distances)
    : proves_(proves_distances) {
  if (!proves_) return;
  threshold_m_ = rounded_up(guard_distance_m(header));
  free_m_ = rounded_down(free_distance_m(header));
  by_value_ = !has_standoff(header);
}

// A distance that is not a number proves nothing.
bool PointRule::is_too_near(float proven_m) const noexcept { return !(proven_m >= threshold_m_); }

// Every point of the set is compared, none is skipped.
void PointRule::mark_points(const float* proven_m, field::ContactSet& set) const noexcept {
  set.barred = 0;
  set.min_distance_m = free_m_;
  set.nearest = field::ContactSet::kNone;
  std::uint32_t proximity = 0;  // points of value 3 that are not barred
  for (std::uint32_t i = 0; i < set.count; ++i) {
    bool barred = by_value_ && field::is_interior(set.value[i]);
    if (proves_) {
      barred = barred || is_too_near(proven_m[i]);
      if (proven_m[i] < set.min_distance_m) {
        set.min_distance_m = proven_m[i];
        set.nearest = i;
      }
    }
    set.is_barred[i] = barred ? 1 : 0;
    set.barred += barred ? 1 : 0;
    proximity += !barred && set.value[i] == static_cast<std::uint8_t>(VoxelValue::kProximity);
  }
  if (by_value_) return;
  set.interior = set.barred;
  set.proximity = proximity;
  set.surface = set.count - set.barred - proximity;
}

bool accepts_pose(const field::ContactSet& here, const field::ContactSet& there) noexcept {
  if (there.barred == 0) return true;
  std::uint32_t at = 0;
  for (std::uint32_t i = 0; i < there.count; ++i) {
    if (there.is_barred[i] == 0) continue;
    while (at < here.count && here.point[at] < there.point[i]) ++at;
    if (at == here.count || here.point[at] != there.point[i]) return false;
    if (here.is_barred[at] == 0) return false;
  }
  return true;
}

bool is_within_travel(double shift_m, double turn_rad, double radius_m,
                      double voxel_size_m) noexcept {
  return shift_m + radius_m * turn_rad <= kMaxTravelVoxels * voxel_size_m;
}

}  // namespace forcelayer::guard

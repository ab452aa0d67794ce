#include "runtime/field/contact_set.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "runtime/field/force_field.h"

namespace forcelayer::field {

void ContactSet::reserve(std::uint64_t points) {
  const std::size_t room = points + kPadding;
  for (auto* values : {&rx, &ry, &rz, &ux, &uy, &uz, &depth_m, &gx, &gy, &gz}) values->resize(room);
  weight.resize(room, 1);
  point.resize(room);
  value.resize(room);
  is_barred.resize(room);
  of_seat.resize(room);
}

void bar_crossings(const ContactSet& earlier, const glm::vec3& way_m, ContactSet& later) noexcept {
  if (!earlier.seat_open || !later.seat_open) return;
  std::uint32_t at = 0;
  for (std::uint32_t i = 0; i < later.count; ++i) {
    if (later.of_seat[i] == 0) continue;
    while (at < earlier.count && earlier.point[at] < later.point[i]) ++at;
    if (at == earlier.count) return;
    if (earlier.point[at] != later.point[i] || earlier.of_seat[at] == 0) continue;
    const glm::vec3 side(earlier.ux[at], earlier.uy[at], earlier.uz[at]);
    const glm::vec3 slope(later.gx[i], later.gy[i], later.gz[i]);
    const glm::vec3 moved_m =
        way_m + glm::vec3(later.rx[i] - earlier.rx[at], later.ry[i] - earlier.ry[at],
                          later.rz[i] - earlier.rz[at]);
    if (!(glm::dot(moved_m, side) < 0 && glm::dot(slope, side) < kLeastSlope)) continue;
    if (later.is_barred[i] == 0) ++later.barred;
    later.is_barred[i] = 1;
    later.ux[i] = side.x, later.uy[i] = side.y, later.uz[i] = side.z;
    later.depth_m[i] = std::max(later.depth_m[i], -glm::dot(moved_m, side));
  }
}

bool none_newly_barred(const ContactSet& earlier, const ContactSet& later) noexcept {
  if (later.barred == 0) return true;
  std::uint32_t at = 0;
  for (std::uint32_t i = 0; i < later.count; ++i) {
    if (later.is_barred[i] == 0) continue;
    while (at < earlier.count && earlier.point[at] < later.point[i]) ++at;
    if (at == earlier.count || earlier.point[at] != later.point[i]) return false;
    if (earlier.is_barred[at] == 0) return false;
  }
  return true;
}

}  // namespace forcelayer::field

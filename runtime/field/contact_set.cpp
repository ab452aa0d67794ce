#include "runtime/field/contact_set.h"

namespace forcelayer::field {

void ContactSet::reserve(std::uint64_t points) {
  const std::size_t room = points + kPadding;
  for (auto* values : {&rx, &ry, &rz, &ux, &uy, &uz, &depth_m}) values->resize(room);
  weight.resize(room, 1);
  point.resize(room);
  value.resize(room);
}

bool no_new_interior(const ContactSet& earlier, const ContactSet& later) noexcept {
  if (later.interior == 0) return true;
  std::uint32_t at = 0;
  for (std::uint32_t i = 0; i < later.count; ++i) {
    if (!later.is_interior(i)) continue;
    while (at < earlier.count && earlier.point[at] < later.point[i]) ++at;
    if (at == earlier.count || earlier.point[at] != later.point[i]) return false;
    if (!earlier.is_interior(at)) return false;
  }
  return true;
}

}  // namespace forcelayer::field

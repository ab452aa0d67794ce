#include "runtime/field/contact_set.h"

namespace forcelayer::field {

void ContactSet::reserve(std::uint64_t points) {
  const std::size_t room = points + kPadding;
  for (auto* values :
       {&rx, &ry, &rz, &ux, &uy, &uz, &depth_m, &ax, &ay, &az, &gx, &gy, &gz, &sx, &sy, &sz})
    values->resize(room);
  weight.resize(room, 1);
  point.resize(room);
  value.resize(room);
  is_barred.resize(room);
  of_seat.resize(room);
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

#include "runtime/field/contact_set.h"

namespace forcelayer::field {

void ContactSet::reserve(std::uint64_t points) {
  const std::size_t room = points + kPadding;
  for (auto* values : {&rx, &ry, &rz, &ux, &uy, &uz, &depth_m, &ax, &ay, &az, &gx, &gy, &gz, &sx,
                       &sy, &sz, &from_surface_m})
    values->resize(room);
  weight.resize(room, 1);
  point.resize(room);
  value.resize(room);
  is_barred.resize(room);
  of_seat.resize(room);
}

}  // namespace forcelayer::field

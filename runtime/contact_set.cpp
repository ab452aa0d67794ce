#include "runtime/contact_set.h"

#include <algorithm>

namespace forcelayer {

Touching ContactSet::touching() const noexcept {
  Touching touching;
  for (std::uint32_t i = 0; i < count; ++i) {
    touching.count += contacts[i].depth_m > 0;
    touching.depth_m = std::max(touching.depth_m, contacts[i].depth_m);
  }
  return touching;
}

bool no_new_interior(const ContactSet& earlier, const ContactSet& later) noexcept {
  if (later.interior == 0) return true;
  std::uint32_t at = 0;
  for (std::uint32_t i = 0; i < later.count; ++i) {
    if (later.contacts[i].interior == 0) continue;
    const std::uint32_t point = later.contacts[i].point;
    while (at < earlier.count && earlier.contacts[at].point < point) ++at;
    if (at == earlier.count || earlier.contacts[at].point != point) return false;
    if (earlier.contacts[at].interior == 0) return false;
  }
  return true;
}

}  // namespace forcelayer

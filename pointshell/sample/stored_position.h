// Positions as a .pshell file stores them.
#pragma once

#include "pointshell/part/vec3.h"

namespace forcelayer::sample {

// `position`, relative to the shell's center, with its coordinates rounded to floats. Everything
// that is proven of a shell is proven of such positions.
part::Vec3 as_stored(const part::Vec3& position);

}  // namespace forcelayer::sample

// The stale limit that the loop, its output and every device's side begin with.
#pragma once

namespace forcelayer {

// Older than this, neither a reading nor a wrench counts.
inline constexpr double kStaleLimitS = 0.005;

}  // namespace forcelayer

// The stale limits that the loop, its output and every device's side begin with.
#pragma once

namespace forcelayer {

// Older than this, neither a reading nor a wrench counts.
inline constexpr double kStaleLimitS = 0.005;

// The longest stale limit that anyone may ask for. A hand that a wrench is no longer meant for
// feels it for so long at most.
inline constexpr double kStaleCeilingS = 0.05;

// Periods of a device without a reading that are not its fault, and the slowest device with
// motors: its periods of that number are the longest stale limit.
inline constexpr double kStalePeriods = 2.5;
inline constexpr double kMinMotorsHz = kStalePeriods / kStaleCeilingS;

}  // namespace forcelayer

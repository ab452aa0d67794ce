// Ranges of the physical numbers of a run, which no device in a hand, part or scene goes beyond.
// They hold for the command line, C, C++, Python, plugins, HID devices and recordings alike.
#pragma once

#include <string_view>

#include "formats/result.h"

namespace forcelayer {

struct DeviceCapabilities;
struct Parameters;
struct RunRequest;

struct Range {
  double smallest, largest;
};

inline constexpr Range kRatesHz{1, 100'000};
inline constexpr Range kMotionScales{1e-6, 1e6};
inline constexpr Range kThreads{1, 256};
inline constexpr Range kMaxSpeedsMps{1e-3, 10};    // below, no hand could move; none is faster, and
inline constexpr Range kMaxTurnsRadps{1e-3, 100};  // estimated from poses, more would be noise
inline constexpr double kFarthestM = 1e9;          // of a pose

// Errors: kUsage, about `name`, for a value that is not within the range, or no number.
Status check_range(std::string_view name, double value, const Range& range);

// Errors: kUsage, about the first number of its kind that is out of its range: the ratings of a
// device, the numbers of a request but for its settings (derive_parameters.h) and poses, the
// parameters of a recording.
Status check_ratings(const DeviceCapabilities& device);
Status check_numbers(const RunRequest& request);
Status check_recorded(const Parameters& parameters);

}  // namespace forcelayer

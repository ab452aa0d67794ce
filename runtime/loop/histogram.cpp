#include "runtime/loop/histogram.h"

#include <algorithm>
#include <cmath>

namespace forcelayer::loop {

std::uint64_t DurationHistogram::upper_end(std::uint32_t bucket) noexcept {
  if (bucket < kSub) return bucket;
  const std::uint32_t octave = bucket / kSub - 1;
  return ((std::uint64_t{kSub} + bucket % kSub + 1) << octave) - 1;
}

std::uint64_t DurationHistogram::quantile_ns(double fraction) const {
  if (count_ == 0) return 0;
  const double wanted = std::ceil(fraction * static_cast<double>(count_));
  std::uint64_t seen = 0;
  for (std::uint32_t bucket = 0; bucket < kBuckets; ++bucket) {
    seen += buckets_[bucket];
    if (seen > 0 && static_cast<double>(seen) >= wanted)
      return std::min(upper_end(bucket), max_ns_);
  }
  return max_ns_;
}

}  // namespace forcelayer::loop

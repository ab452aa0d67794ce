// A histogram of durations in constant memory: log-linear buckets of at most 1/64 of their value.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace forcelayer::loop {

// Counts whole nanoseconds up to 2^40 (18 minutes; longer ones fall into the last bucket). Negative
// values count as 0. Values below 64 are kept exactly.
class DurationHistogram {
 public:
  void record(std::int64_t ns) noexcept {
    const auto value = static_cast<std::uint64_t>(ns > 0 ? ns : 0);
    ++buckets_[bucket_of(value)];
    ++count_;
    if (value > max_ns_) max_ns_ = value;
  }

  std::uint64_t count() const { return count_; }
  std::uint64_t max_ns() const { return max_ns_; }  // exact

  // Smallest bucket's upper end that at least `fraction` of the values do not exceed, at most
  // max_ns(). 0 where nothing was recorded.
  std::uint64_t quantile_ns(double fraction) const;

 private:
  static constexpr std::uint32_t kSubBits = 6;  // 64 buckets an octave
  static constexpr std::uint32_t kSub = 1u << kSubBits;
  static constexpr std::uint32_t kMaxBits = 40;
  static constexpr std::uint32_t kBuckets = (kMaxBits - kSubBits + 1) * kSub;

  static std::uint32_t bucket_of(std::uint64_t value) noexcept {
    if (value < kSub) return static_cast<std::uint32_t>(value);
    const auto octave = static_cast<std::uint32_t>(std::bit_width(value)) - kSubBits - 1;
    const auto bucket = (octave + 1) * kSub + static_cast<std::uint32_t>((value >> octave) - kSub);
    return bucket < kBuckets ? bucket : kBuckets - 1;
  }
  static std::uint64_t upper_end(std::uint32_t bucket) noexcept;

  std::array<std::uint64_t, kBuckets> buckets_{};
  std::uint64_t count_ = 0;
  std::uint64_t max_ns_ = 0;
};

}  // namespace forcelayer::loop

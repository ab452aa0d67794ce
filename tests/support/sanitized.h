// Less work for the same assertion under sanitizers, where a test takes ten times as long: they
// look for faults of memory and arithmetic, which a few of many random cases find, and every case
// runs without them.
#pragma once

#include <cstdint>

namespace forcelayer::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

// From one seed to the next: 1 without sanitizers. A step that divides none of the periods with
// which a test changes its kinds of cases still meets them all.
constexpr std::uint64_t seed_step(std::uint64_t under_sanitizers) {
  return kSanitized ? under_sanitizers : 1;
}

}  // namespace forcelayer::test

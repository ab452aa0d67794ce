// Less work for the same assertion under sanitizers, where a test takes ten times as long: they
// look for faults of memory and arithmetic, which a few of many random cases find, and every case
// runs without them.
#pragma once

#include <cstdint>

// gcc and clang tell it in different ways.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define FORCELAYER_TEST_SANITIZED 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define FORCELAYER_TEST_SANITIZED 1
#endif
#endif
#ifndef FORCELAYER_TEST_SANITIZED
#define FORCELAYER_TEST_SANITIZED 0
#endif

namespace forcelayer::test {

inline constexpr bool kSanitized = FORCELAYER_TEST_SANITIZED;

// From one seed to the next: 1 without sanitizers. A step that divides none of the periods with
// which a test changes its kinds of cases still meets them all.
constexpr std::uint64_t seed_step(std::uint64_t under_sanitizers) {
  return kSanitized ? under_sanitizers : 1;
}

}  // namespace forcelayer::test

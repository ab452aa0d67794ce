// Whether the tests are compiled for a sanitizer, which gcc and clang tell in different ways.
#pragma once

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

// A sanitizer finds errors of memory, which do not depend on how often or at how many scales the
// same code runs: where a test judges something else by many cases, a share of them is enough
// there.
inline constexpr bool kSanitized = FORCELAYER_TEST_SANITIZED;

}  // namespace forcelayer::test

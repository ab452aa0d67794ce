// FORCELAYER_LONG_TESTS=1 in the environment lets random tests run for hours instead of seconds.
#pragma once

#include <cstdlib>

namespace forcelayer::test {

inline bool long_tests() { return std::getenv("FORCELAYER_LONG_TESTS") != nullptr; }

}  // namespace forcelayer::test

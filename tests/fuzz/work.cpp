#include "tests/fuzz/work.h"

namespace {
std::uint64_t blocks = 0;
}

std::uint64_t forcelayer::fuzz::work() { return __atomic_load_n(&blocks, __ATOMIC_RELAXED); }

// Called by every basic block that is compiled with -fsanitize-coverage=trace-pc, in the place of
// __sanitizer_cov_trace_pc (ld's --wrap).
extern "C"
#ifdef __clang__
    __attribute__((no_sanitize("coverage")))
#else
    __attribute__((no_sanitize_coverage))
#endif
    void
    __wrap___sanitizer_cov_trace_pc() {
  // No target works on two threads at a time; were there two, a block might not count.
  __atomic_store_n(&blocks, __atomic_load_n(&blocks, __ATOMIC_RELAXED) + 1, __ATOMIC_RELAXED);
}

// Preloaded into what valgrind runs: Highway's library measures the processor's clock while it is
// loaded, with an instruction that valgrind refuses where the kernel does not name it.
#include <cstdint>

namespace hwy::platform {

std::uint64_t TimerResolution();
std::uint64_t TimerResolution() { return 1; }  // of a timer that voxrun does not use

}  // namespace hwy::platform

// When it is loaded, Highway's library measures for 6 ms how finely the processor's timer runs, for
// benchmarks that use its timer; a bake from a cache takes 60 ms in all. Nobody here asks for it:
// this definition in the executable comes before the library's.
#include <cstdint>

namespace hwy::platform {

std::uint64_t TimerResolution();
std::uint64_t TimerResolution() { return 1; }

}  // namespace hwy::platform

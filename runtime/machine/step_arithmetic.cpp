#include "runtime/machine/step_arithmetic.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace forcelayer::machine {
namespace {

#if defined(__SSE2__)
constexpr std::uint64_t kControl = 0x9fc0;  // all exceptions masked, nearest, FTZ and DAZ
std::uint64_t control() { return _mm_getcsr(); }
void set_control(std::uint64_t bits) { _mm_setcsr(static_cast<unsigned>(bits)); }
#elif defined(__aarch64__)
constexpr std::uint64_t kControl = std::uint64_t{1} << 24;  // FZ; nothing traps, nearest
std::uint64_t control() {
  std::uint64_t bits = 0;
  asm volatile("mrs %0, fpcr" : "=r"(bits));
  return bits;
}
void set_control(std::uint64_t bits) { asm volatile("msr fpcr, %0" : : "r"(bits) : "memory"); }
#else
constexpr std::uint64_t kControl = 0;
std::uint64_t control() { return 0; }
void set_control(std::uint64_t) {}
#endif

}  // namespace

// Not inline: the compiler, which knows nothing of this state, moves no arithmetic past the calls.
StepArithmetic::StepArithmetic() noexcept : host_(control()) { set_control(kControl); }

StepArithmetic::~StepArithmetic() { set_control(host_); }

}  // namespace forcelayer::machine

#include "runtime/real_time.h"

#include <errno.h>
#include <sched.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace forcelayer {
namespace {

constexpr int kPriority = 80;  // above interrupt threads' default of 50, below the watchdogs' 99
constexpr std::size_t kStackBytes = 256 * 1024;
constexpr long long kNsPerS = 1'000'000'000;

void prefault_stack() noexcept {
  unsigned char stack[kStackBytes];
  std::memset(stack, 0, kStackBytes);
  asm volatile("" : : "r"(stack) : "memory");  // keeps the compiler from dropping it
}

}  // namespace

void flush_denormals() noexcept {
#if defined(__SSE2__)
  _mm_setcsr(_mm_getcsr() | 0x8040u);  // FTZ and DAZ
#elif defined(__aarch64__)
  unsigned long long control = 0;
  asm volatile("mrs %0, fpcr" : "=r"(control));
  asm volatile("msr fpcr, %0" : : "r"(control | (1ull << 24)));
#endif
}

std::vector<std::string> lock_memory() {
  prefault_stack();
  // Pages are locked as they are touched: a scene's untouched pages are never read.
  if (mlockall(MCL_CURRENT | MCL_FUTURE | MCL_ONFAULT) == 0) return {};
  return {std::string("memory is not locked (") + std::strerror(errno) +
          "): pages may be swapped out under the loop; raise the memlock limit "
          "(/etc/security/limits.d: @realtime - memlock unlimited)"};
}

std::vector<std::string> take_real_time_priority() {
  sched_param parameters{};
  parameters.sched_priority = kPriority;
  if (sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters) == 0) return {};
  return {std::string("no real-time priority (") + std::strerror(errno) +
          "): other programs will delay the loop; raise the rtprio limit "
          "(/etc/security/limits.d: @realtime - rtprio 90)"};
}

long long monotonic_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * kNsPerS + now.tv_nsec;
}

double steal_seconds() {
  std::FILE* const file = std::fopen("/proc/stat", "re");
  if (file == nullptr) return 0;
  unsigned long long stolen = 0;
  const int read = std::fscanf(file, "cpu %*u %*u %*u %*u %*u %*u %*u %llu", &stolen);
  std::fclose(file);
  return read == 1 ? static_cast<double>(stolen) / static_cast<double>(sysconf(_SC_CLK_TCK)) : 0;
}

void sleep_until_ns(long long deadline_ns) noexcept {
  const timespec deadline{deadline_ns / kNsPerS, static_cast<long>(deadline_ns % kNsPerS)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &deadline, nullptr) == EINTR) {
  }
}

}  // namespace forcelayer

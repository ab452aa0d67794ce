#include "runtime/machine/real_time.h"

#include <errno.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>

namespace forcelayer::machine {
namespace {

constexpr int kPriority = 80;  // above interrupt threads' default of 50, below the watchdogs' 99
constexpr std::size_t kStackBytes = 256 * 1024;
constexpr long long kNsPerS = 1'000'000'000;

void prefault_stack() noexcept {
  unsigned char stack[kStackBytes];
  std::memset(stack, 0, kStackBytes);
  asm volatile("" : : "r"(stack) : "memory");  // keeps the compiler from dropping it
}

std::vector<std::string> no_priority(int number, const char* whose) {
  return {std::string("real-time priority is refused") + whose + " (" + std::strerror(number) +
          "): other programs will delay the loop; raise the rtprio limit "
          "(/etc/security/limits.d: @realtime - rtprio 90)"};
}

// Whether a limit on locked memory holds for what is mapped from now on: whether so much would be
// refused because of it. Nothing of it is touched.
bool is_limited() noexcept {
  constexpr std::size_t kMuch = std::size_t{1} << 40;
  constexpr int kFlags = MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE;
  void* const mapped = mmap(nullptr, kMuch, PROT_NONE, kFlags, -1, 0);
  if (mapped == MAP_FAILED) return errno == EAGAIN;
  munmap(mapped, kMuch);
  return false;
}

}  // namespace

std::vector<std::string> lock_memory() {
  prefault_stack();
  // Pages are locked as they are touched: of the 8 MiB of a thread's stack few are.
  constexpr int kNow = MCL_CURRENT | MCL_ONFAULT;
  bool locked = mlockall(kNow | MCL_FUTURE) == 0;
  int number = errno;
  if (locked && is_limited()) {
    // Else the limit would refuse mappings to come: stacks of threads, a next scene.
    mlockall(kNow);
    locked = false;
    number = EAGAIN;
  }
  if (locked) return {};
  return {std::string("memory is not locked (") + std::strerror(number) +
          "): pages may be swapped out while the loop runs; raise the memlock limit "
          "(/etc/security/limits.d: @realtime - memlock unlimited)"};
}

std::vector<std::string> take_real_time_priority(int below) {
  sched_param parameters{};
  parameters.sched_priority = kPriority - below;
  if (sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters) == 0) return {};
  return no_priority(errno, "");
}

void limit_real_time_priority(int below) noexcept {
  const auto largest = static_cast<rlim_t>(kPriority - below);
  rlimit limit{};
  if (getrlimit(RLIMIT_RTPRIO, &limit) != 0) return;
  limit = {std::min(limit.rlim_cur, largest), std::min(limit.rlim_max, largest)};
  (void)setrlimit(RLIMIT_RTPRIO, &limit);
}

std::vector<std::string> give_real_time_priority(std::span<std::thread> helpers) {
  cpu_set_t cores;
  if (sched_getaffinity(0, sizeof cores, &cores) == 0 &&
      static_cast<std::size_t>(CPU_COUNT(&cores)) <= helpers.size()) {
    return {"helper threads get no real-time priority: " + std::to_string(helpers.size() + 1) +
            " threads on " + std::to_string(CPU_COUNT(&cores)) + " cores; use a smaller --threads"};
  }
  sched_param parameters{};
  parameters.sched_priority = kPriority - 1;
  for (std::thread& helper : helpers) {
    const int refused = pthread_setschedparam(helper.native_handle(), SCHED_FIFO, &parameters);
    if (refused != 0) return no_priority(refused, " for helper threads");
  }
  return {};
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

}  // namespace forcelayer::machine

// Asks the system for real-time scheduling and locked memory, and reads its clock. A refusal gives
// a warning that names the remedy; the program goes on without.
#pragma once

#include <span>
#include <string>
#include <thread>
#include <vector>

namespace forcelayer::machine {

// Locks every page that the process touches from now on, and touches 256 KiB of this thread's
// stack. Returns warnings.
std::vector<std::string> lock_memory();

// SCHED_FIFO for this thread, at the loop's priority or so many below it. Returns warnings.
std::vector<std::string> take_real_time_priority(int below = 0);

// This process takes no higher priority than that from now on, unless it has the capability.
void limit_real_time_priority(int below) noexcept;

// SCHED_FIFO for the helpers of this thread, one priority below it, so that a helper that looks for
// work never delays it. Helpers keep their ordinary priority where the threads outnumber the cores:
// this thread would wait for a helper and hold the core that the helper needs. Returns warnings.
std::vector<std::string> give_real_time_priority(std::span<std::thread> helpers);

// Sleeps until CLOCK_MONOTONIC reaches `deadline_ns`; returns at once where it has. A signal does
// not cut the sleep short.
void sleep_until_ns(long long deadline_ns) noexcept;

long long monotonic_ns() noexcept;

// Seconds that the host of a virtual machine has taken from all cores since the start (/proc/stat);
// 0 where it does not say.
double steal_seconds();

}  // namespace forcelayer::machine

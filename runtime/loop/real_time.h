// Asking the system for real time: scheduling, locked memory. Each is degraded with a line that
// says what to do about it.
#pragma once

#include <span>
#include <string>
#include <thread>
#include <vector>

namespace forcelayer {

// Locks what the process touches from now on, and faults in 256 KiB of this thread's stack.
// Returns warnings.
std::vector<std::string> lock_memory();

// SCHED_FIFO for this thread. Returns warnings.
std::vector<std::string> take_real_time_priority();

// The same for threads that help this one while it waits for them, a step below it: it is never
// held up by a helper that only looks for work. They keep their ordinary priority where this thread
// and they are more than the cores it may use: a helper that waits for a core could not be waited
// for without taking it from everybody. Returns warnings.
std::vector<std::string> give_real_time_priority(std::span<std::thread> helpers);

// Sleeps until CLOCK_MONOTONIC reaches `deadline_ns`; returns at once where it has. Signals do not
// cut it short unless they set what the caller looks at.
void sleep_until_ns(long long deadline_ns) noexcept;

long long monotonic_ns() noexcept;

// Seconds that the host of a virtual machine has taken from all cores since the start (/proc/stat);
// 0 where it does not say.
double steal_seconds();

}  // namespace forcelayer

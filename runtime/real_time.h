// Asking the system for real time: scheduling, locked memory, flushed denormals. Each is degraded
// with a line that says what to do about it.
#pragma once

#include <string>
#include <vector>

namespace forcelayer {

// Denormal results and operands count as zero in this thread from now on: they cost hundreds of
// cycles each.
void flush_denormals() noexcept;

// Locks what the process touches from now on, and faults in 256 KiB of this thread's stack.
// Returns warnings.
std::vector<std::string> lock_memory();

// SCHED_FIFO for this thread. Returns warnings.
std::vector<std::string> take_real_time_priority();

// Sleeps until CLOCK_MONOTONIC reaches `deadline_ns`; returns at once where it has. Signals do not
// cut it short unless they set what the caller looks at.
void sleep_until_ns(long long deadline_ns) noexcept;

long long monotonic_ns() noexcept;

// Seconds that the host of a virtual machine has taken from all cores since the start (/proc/stat);
// 0 where it does not say.
double steal_seconds();

}  // namespace forcelayer

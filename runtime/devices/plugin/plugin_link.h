// The memory that voxrun and its plugin's process share. Neither trusts what the other could have
// written: each keeps its own indices, copies before it checks, and the memory is sealed. Both are
// built from the same source; the version is checked all the same, since the process is found by
// its path.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

#include "forcelayer/plugin.h"
#include "forcelayer/stale_limit.h"
#include "runtime/machine/latest_value.h"

namespace forcelayer::devices {

inline constexpr std::uint32_t kPluginLinkVersion = 3;
inline constexpr std::uint32_t kPluginLinkGuard = 0x464c5047;

enum class PluginState : std::uint32_t {
  kStarting,  // the process has not spoken yet
  kOpen,      // info is filled in
  kFailed,    // error is filled in
  kLost,      // the device went away
  kClosed,    // ended in order, motors at zero
};

struct PluginReading {
  forcelayer_plugin_reading reading;
  std::uint64_t sequence;     // from 1
  std::uint32_t output_held;  // 1: the process keeps the motors at zero
  double output_falls;        // DeviceSample::output_falls
};

struct PluginCommand {
  forcelayer_plugin_wrench wrench;
  std::int64_t written_ns;  // CLOCK_MONOTONIC, which both processes share
};

struct PluginLink {
  std::atomic<std::uint32_t> version{kPluginLinkVersion};
  double stale_s = kStaleLimitS;
  std::atomic<PluginState> state{PluginState::kStarting};
  std::atomic<std::uint32_t> stop{0};  // by the host
  std::array<char, 256> error{};
  forcelayer_plugin_info info{};
  alignas(64) machine::SharedValue<PluginReading> readings;  // process to host
  alignas(64) machine::SharedValue<PluginCommand> commands;  // host to process
  std::atomic<std::uint32_t> guard{kPluginLinkGuard};  // the last word, as version is the first

  // Whether the ends are as they were made. What a wild write left between them is judged as what a
  // device says: states, indices, readings.
  bool whole() const noexcept {
    return version.load(std::memory_order_relaxed) == kPluginLinkVersion &&
           guard.load(std::memory_order_relaxed) == kPluginLinkGuard;
  }
};
static_assert(std::atomic<std::uint32_t>::is_always_lock_free);

}  // namespace forcelayer::devices

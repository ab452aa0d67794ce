// Helper threads of the contact query: woken by the loop before a step, spinning inside it, asleep
// otherwise. run() itself makes no system call and takes no lock.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

namespace forcelayer::query {

class QueryWorkers {
 public:
  // A chunk of work; called from several threads at once, each chunk once.
  using Job = void (*)(void* context, std::uint32_t chunk) noexcept;
  static constexpr std::uint32_t kMostChunks = 1u << 16;

  explicit QueryWorkers(unsigned helpers);
  ~QueryWorkers();
  QueryWorkers(const QueryWorkers&) = delete;
  QueryWorkers& operator=(const QueryWorkers&) = delete;

  // Calls the system: for the loop, outside the step.
  void wake() noexcept;
  void rest() noexcept;

  // Runs job(context, 0..chunks-1) on this thread and on the helpers that are awake; returns when
  // all are done. `chunks` at most kMostChunks.
  void run(Job job, void* context, std::uint32_t chunks) noexcept;

  // For the helpers, once; returns warnings (real_time.h).
  std::vector<std::string> take_real_time_priority();

  unsigned helpers() const { return static_cast<unsigned>(threads_.size()); }

 private:
  void help() noexcept;
  bool take_chunk() noexcept;

  // generation (high 30 bits) | chunks (17) | next chunk (17): one word, so that a helper that was
  // held up takes no chunk of a job that has ended.
  std::atomic<std::uint64_t> ticket_{0};
  std::atomic<std::uint32_t> done_{0};
  std::atomic<std::uint32_t> awake_{0};
  std::atomic<bool> ended_{false};
  Job job_ = nullptr;
  void* context_ = nullptr;
  std::vector<std::thread> threads_;
};

}  // namespace forcelayer::query

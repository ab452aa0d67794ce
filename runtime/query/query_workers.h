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
  static constexpr std::uint32_t kMaxChunks = 1u << 16;

  // Throws std::system_error where the system starts no more threads.
  explicit QueryWorkers(unsigned helpers);
  ~QueryWorkers();
  QueryWorkers(const QueryWorkers&) = delete;
  QueryWorkers& operator=(const QueryWorkers&) = delete;

  // Calls the system: for the loop, outside the step.
  void wake() noexcept;
  void rest() noexcept;

  // Runs job(context, 0..chunks-1) on this thread and on the helpers that are awake; returns when
  // all are done. `chunks` at most kMaxChunks. Each thread begins with a portion of its own, the
  // same in each run of as many chunks, so that its caches hold what its chunks need; then it takes
  // chunks of others.
  void run(Job job, void* context, std::uint32_t chunks) noexcept;

  // For the helpers, once; returns warnings (real_time.h).
  std::vector<std::string> take_real_time_priority();

  // Whether they should be.
  bool awake() const noexcept { return awake_.load(std::memory_order_relaxed) != 0; }
  unsigned helpers() const { return static_cast<unsigned>(threads_.size()); }

 private:
  // On a cache line of its own: threads that take chunks of different portions do not meet.
  struct alignas(64) Portion {
    // generation (high 30 bits) | end (17) | next chunk (17): one word, so that a helper that was
    // held up takes no chunk of a job that has ended.
    std::atomic<std::uint64_t> ticket{0};
  };

  void end() noexcept;
  void help(std::size_t own) noexcept;
  void work(std::size_t own) noexcept;
  bool take_chunk(Portion& portion) noexcept;

  std::vector<Portion> portions_;  // of the caller's thread, then the helpers'
  alignas(64) std::atomic<std::uint64_t> generation_{0};  // of jobs
  alignas(64) std::atomic<std::uint32_t> done_{0};        // chunks
  alignas(64) std::atomic<std::uint32_t> awake_{0};
  std::atomic<bool> ended_{false};
  Job job_ = nullptr;
  void* context_ = nullptr;
  std::vector<std::thread> threads_;
};

}  // namespace forcelayer::query

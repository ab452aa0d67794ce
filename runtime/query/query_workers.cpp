#include "runtime/query/query_workers.h"

#include "runtime/machine/map_loss.h"
#include "runtime/machine/real_time.h"
#include "runtime/machine/step_arithmetic.h"

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace forcelayer::query {
namespace {

constexpr std::uint64_t kCountBits = 17;
constexpr std::uint64_t kCountMask = (std::uint64_t{1} << kCountBits) - 1;

std::uint64_t next_of(std::uint64_t ticket) { return ticket & kCountMask; }
std::uint64_t chunks_of(std::uint64_t ticket) { return (ticket >> kCountBits) & kCountMask; }
std::uint64_t generation_of(std::uint64_t ticket) { return ticket >> (2 * kCountBits); }

void pause() noexcept {
#if defined(__SSE2__)
  _mm_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

}  // namespace

QueryWorkers::QueryWorkers(unsigned helpers) {
  for (unsigned i = 0; i < helpers; ++i) threads_.emplace_back([this] { help(); });
}

QueryWorkers::~QueryWorkers() {
  ended_.store(true);
  wake();
  for (std::thread& thread : threads_) thread.join();
}

void QueryWorkers::wake() noexcept {
  awake_.store(1);
  awake_.notify_all();
}

void QueryWorkers::rest() noexcept { awake_.store(0); }

std::vector<std::string> QueryWorkers::take_real_time_priority() {
  return machine::give_real_time_priority(threads_);
}

// Takes the next chunk of the job at hand and does it. False where none is left.
bool QueryWorkers::take_chunk() noexcept {
  std::uint64_t ticket = ticket_.load(std::memory_order_acquire);
  do {
    if (next_of(ticket) >= chunks_of(ticket)) return false;
  } while (!ticket_.compare_exchange_weak(ticket, ticket + 1, std::memory_order_acq_rel,
                                          std::memory_order_acquire));
  // The job cannot end, nor job_ change, before this chunk is counted as done.
  // A chunk that a changed file led astray is done as well: the step hears of the file at its end.
  machine::Landing landing;
  if (sigsetjmp(landing.here, 0) == 0) job_(context_, static_cast<std::uint32_t>(next_of(ticket)));
  done_.fetch_add(1, std::memory_order_release);
  return true;
}

void QueryWorkers::help() noexcept {
  const machine::StepArithmetic arithmetic;
  while (!ended_.load(std::memory_order_relaxed)) {
    if (awake_.load(std::memory_order_relaxed) == 0) {
      awake_.wait(0);
    } else if (!take_chunk()) {
      pause();
    }
  }
}

void QueryWorkers::run(Job job, void* context, std::uint32_t chunks) noexcept {
  job_ = job;
  context_ = context;
  done_.store(0, std::memory_order_relaxed);
  const std::uint64_t generation = generation_of(ticket_.load(std::memory_order_relaxed)) + 1;
  ticket_.store((generation << (2 * kCountBits)) | (std::uint64_t{chunks} << kCountBits),
                std::memory_order_release);
  while (take_chunk()) {
  }
  while (done_.load(std::memory_order_acquire) != chunks) pause();
}

}  // namespace forcelayer::query

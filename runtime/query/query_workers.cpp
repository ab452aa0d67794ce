#include "runtime/query/query_workers.h"

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
std::uint64_t end_of(std::uint64_t ticket) { return (ticket >> kCountBits) & kCountMask; }

void pause() noexcept {
#if defined(__SSE2__)
  _mm_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

}  // namespace

QueryWorkers::QueryWorkers(unsigned helpers) : portions_(helpers + std::size_t{1}) {
  try {
    for (std::size_t own = 1; own <= helpers; ++own) {
      threads_.emplace_back([this, own] { help(own); });
    }
  } catch (...) {
    end();
    throw;
  }
}

QueryWorkers::~QueryWorkers() { end(); }

void QueryWorkers::end() noexcept {
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

// Takes the next chunk of a portion and does it. False where none is left.
bool QueryWorkers::take_chunk(Portion& portion) noexcept {
  std::uint64_t ticket = portion.ticket.load(std::memory_order_acquire);
  do {
    if (next_of(ticket) >= end_of(ticket)) return false;
  } while (!portion.ticket.compare_exchange_weak(ticket, ticket + 1, std::memory_order_acq_rel,
                                                 std::memory_order_acquire));
  // The job cannot end, nor job_ change, before this chunk is counted as done.
  job_(context_, static_cast<std::uint32_t>(next_of(ticket)));
  return true;
}

// Does the chunks of a thread's own portion, then those that others have left.
void QueryWorkers::work(std::size_t own) noexcept {
  std::uint32_t done = 0;
  for (std::size_t i = 0; i < portions_.size(); ++i) {
    while (take_chunk(portions_[(own + i) % portions_.size()])) ++done;
  }
  if (done > 0) done_.fetch_add(done, std::memory_order_release);
}

void QueryWorkers::help(std::size_t own) noexcept {
  const machine::StepArithmetic arithmetic;
  std::uint64_t helped = 0;  // the last generation
  while (!ended_.load(std::memory_order_relaxed)) {
    if (awake_.load(std::memory_order_relaxed) == 0) {
      awake_.wait(0);
    } else if (const std::uint64_t now = generation_.load(std::memory_order_acquire);
               now != helped) {
      helped = now;
      work(own);
    } else {
      pause();
    }
  }
}

void QueryWorkers::run(Job job, void* context, std::uint32_t chunks) noexcept {
  job_ = job;
  context_ = context;
  done_.store(0, std::memory_order_relaxed);
  const std::uint64_t generation = generation_.load(std::memory_order_relaxed) + 1;
  for (std::size_t i = 0; i < portions_.size(); ++i) {
    const std::uint64_t begin = chunks * i / portions_.size(),
                        end = chunks * (i + 1) / portions_.size();
    portions_[i].ticket.store(generation << (2 * kCountBits) | end << kCountBits | begin,
                              std::memory_order_release);
  }
  generation_.store(generation, std::memory_order_release);
  work(0);
  while (done_.load(std::memory_order_acquire) != chunks) pause();
}

}  // namespace forcelayer::query

// Loops over indices on all threads. Whatever is computed for index i must depend on i alone, so
// that the result is the same for any number of threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>

namespace forcelayer::part {

// Calls body(begin, end) on disjoint ranges that cover [0, count); a range holds at most `grain`.
void parallel_ranges(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t begin, std::size_t end)>& body);

// Calls body(i) for every i in [0, count).
template <typename Body>
void parallel_for_each_index(std::size_t count, std::size_t grain, const Body& body) {
  parallel_ranges(count, grain, [&body](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

// Called with the fraction of some work that is done, in [0, 1]; may be empty.
using Progress = std::function<void(double fraction_done)>;

// Counts what threads have done of `all`, and reports the fraction done: one thread at a time, the
// others go on.
class DoneWork {
 public:
  DoneWork(const Progress& progress, double all) : progress_(progress), all_(all) {}

  void add(double done) {
    done_.fetch_add(done, std::memory_order_relaxed);
    if (!progress_ || !(all_ > 0) || !telling_.try_lock()) return;
    const std::lock_guard lock(telling_, std::adopt_lock);
    progress_(std::min(1.0, done_.load(std::memory_order_relaxed) / all_));
  }

 private:
  const Progress& progress_;
  const double all_;
  std::atomic<double> done_{0};
  std::mutex telling_;
};

// Runs `body` with at most `threads` threads in all parallel loops; 0 means all of the machine's.
void with_threads(unsigned threads, const std::function<void()>& body);

}  // namespace forcelayer::part

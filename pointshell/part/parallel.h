// Loops over indices on all threads. Whatever is computed for index i must depend on i alone, so
// that the result is the same for any number of threads.
#pragma once

#include <cstddef>
#include <functional>

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

// Runs `body` with at most `threads` threads in all parallel loops; 0 means all of the machine's.
void with_threads(unsigned threads, const std::function<void()>& body);

}  // namespace forcelayer::part

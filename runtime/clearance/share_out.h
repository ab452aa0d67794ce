// Work that several threads share.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <system_error>
#include <thread>
#include <vector>

namespace forcelayer::clearance {

// Calls work(thread, task) for each task, each from one of the threads; the caller's is one of
// them. Where the system starts no more, fewer do it.
inline void share_out(unsigned threads, std::size_t tasks,
                      const std::function<void(std::size_t, std::size_t)>& work) {
  std::atomic<std::size_t> next{0};
  const auto run = [&](std::size_t thread) {
    for (std::size_t task = next++; task < tasks; task = next++) work(thread, task);
  };
  std::vector<std::thread> others;
  try {
    for (unsigned n = 1; n < threads; ++n) others.emplace_back(run, n);
  } catch (const std::system_error&) {
  }
  run(0);
  for (std::thread& other : others) other.join();
}

}  // namespace forcelayer::clearance

// Work that is spread over the machine's cores.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace forcelayer::pairs {

// Calls `work` with each number below `count` once, in any order, from several threads at a time,
// and `progress` in this thread with how many are done. An exception of one call is thrown here,
// after all threads have ended.
template <typename Work, typename Progress>
void for_each_number(std::size_t count, const Work& work, const Progress& progress) {
  std::atomic<std::size_t> next = 0, done = 0;
  std::mutex failing;
  std::exception_ptr failure;
  const auto take = [&](bool shows) {
    try {
      for (std::size_t n; (n = next++) < count;) {
        work(n);
        ++done;
        if (shows) progress(done.load());
      }
    } catch (...) {
      const std::lock_guard lock(failing);
      failure = std::current_exception();
      next = count;
    }
  };
  std::vector<std::thread> others;
  const std::size_t threads =
      std::min<std::size_t>(std::max(1u, std::thread::hardware_concurrency()), count);
  try {
    for (std::size_t n = 1; n < threads; ++n) others.emplace_back(take, false);
  } catch (const std::system_error&) {  // the system gives no more: those that there are do all
  }
  take(true);
  for (std::thread& other : others) other.join();
  if (failure) std::rethrow_exception(failure);
}

}  // namespace forcelayer::pairs

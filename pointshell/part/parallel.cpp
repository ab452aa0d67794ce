#include "pointshell/part/parallel.h"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

namespace forcelayer::part {

void parallel_ranges(std::size_t count, std::size_t grain,
                     const std::function<void(std::size_t, std::size_t)>& body) {
  if (count == 0) return;
  tbb::parallel_for(
      tbb::blocked_range<std::size_t>(0, count, std::max<std::size_t>(grain, 1)),
      [&body](const tbb::blocked_range<std::size_t>& range) { body(range.begin(), range.end()); },
      tbb::simple_partitioner());
}

void with_threads(unsigned threads, const std::function<void()>& body) {
  // More threads than the machine runs at once would only draw a warning from the library.
  const int largest = tbb::info::default_concurrency();
  tbb::task_arena arena(threads == 0 ? largest : std::min(static_cast<int>(threads), largest));
  arena.execute(body);
}

}  // namespace forcelayer::part

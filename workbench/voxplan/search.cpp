#include "workbench/voxplan/search.h"

#include <algorithm>
#include <chrono>
#include <glm/geometric.hpp>
#include <mutex>
#include <utility>

#include "runtime/clearance/share_out.h"
#include "workbench/voxplan/search_worker.h"

namespace forcelayer::voxplan {
namespace {

constexpr std::uint64_t kPosesARound = 4000;  // that each worker tests

using SearchWorkers = std::vector<std::unique_ptr<SearchWorker>>;

// Takes the path of the first worker that has one which is proven clear. Every worker then avoids
// the poses at which other paths were not.
Status take_proven(const Problem& problem, const SearchWorkers& workers,
                   const SearchRequest& request, SearchResult& result) {
  for (const auto& worker : workers) {
    if (!worker->is_done()) continue;
    if (request.unproven_at) {
      const auto at = request.unproven_at(worker->in_seat(), worker->beyond());
      if (!at) return at.error();
      if (*at) {
        ++result.refused;
        result.is_start_refused |= travel_between_m(problem, problem.world_from_start, **at) == 0;
        for (const auto& other : workers) other->refuse(**at);
        continue;
      }
    }
    result.found = true;
    result.in_seat = worker->in_seat();
    result.beyond = worker->beyond();
    return {};
  }
  return {};
}

}  // namespace

double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Result<SearchResult> search(const Problem& problem, const Destination& goal,
                            const SearchRequest& request) {
  const double begin_s = request.clock_s(), end_s = begin_s + request.max_s;
  seed_planners(request.seed);
  SearchWorkers workers;
  for (std::size_t n = 0; n < kWorkers; ++n) {
    auto check = request.make_check(problem);
    if (!check) return check.error();
    workers.push_back(
        std::make_unique<SearchWorker>(problem, goal, n, request.seed, std::move(*check)));
  }
  SearchResult result;
  std::mutex reporting;
  const auto report = [&](double now_s) {
    const std::unique_lock lock(reporting, std::try_to_lock);
    if (!lock || !request.progress) return;
    request.progress(std::min(1.0, (now_s - begin_s) / request.max_s), result.out_m);
  };
  // All workers do the same work in a round, so the path does not depend on the clock.
  if (Status s = take_proven(problem, workers, request, result); !s) return s.error();
  std::uint64_t round = 0, next_note = 0, last_tested = 0;
  while (!result.found && !result.is_start_refused && request.clock_s() < end_s) {
    clearance::share_out(std::min<unsigned>(request.threads, kWorkers), kWorkers,
                         [&](std::size_t, std::size_t n) {
                           workers[n]->work(kPosesARound, [&] {
                             const double now_s = request.clock_s();
                             report(now_s);  // a round may take seconds
                             return now_s >= end_s;
                           });
                         });
    const bool notes = ++round >= next_note;
    if (notes) next_note = 2 * round;
    for (const auto& worker : workers) {
      worker->take_stock();
      if (notes) worker->note_farthest();
      result.out_m = std::max(result.out_m, worker->out_m());
    }
    if (Status s = take_proven(problem, workers, request, result); !s) return s.error();
    // Planners give up at once where the start itself is refused: more time would find nothing.
    std::uint64_t tested = 0;
    for (const auto& worker : workers) tested += worker->poses_tested();
    if (std::exchange(last_tested, tested) == tested) break;
  }
  for (const auto& worker : workers) {
    if (!result.found) worker->note_farthest();
    result.out_m = std::max(result.out_m, worker->out_m());
  }
  const auto farthest = std::find_if(workers.begin(), workers.end(), [&](const auto& worker) {
    return worker->out_m() >= result.out_m;
  });
  if (!result.found) result.blocked_by = (*farthest)->blocked_by();
  for (const auto& worker : workers) {
    result.poses_tested += worker->poses_tested();
    result.motions_tested += worker->motions_tested();
    result.motions_kept += worker->motions_kept();
    result.kept_m += worker->kept_m();
  }
  result.seconds = request.clock_s() - begin_s;
  return result;
}

}  // namespace forcelayer::voxplan

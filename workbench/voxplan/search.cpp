#include "workbench/voxplan/search.h"

#include <algorithm>
#include <chrono>
#include <glm/geometric.hpp>
#include <map>
#include <mutex>
#include <utility>

#include "runtime/clearance/share_out.h"
#include "workbench/exact/watch.h"
#include "workbench/voxplan/search_worker.h"

namespace forcelayer::voxplan {
namespace {

constexpr std::uint64_t kPosesARound = 4000;  // that each worker tests
// Straight paths by the meshes get no more than this of the time: people pull that way.
constexpr double kStraightFraction = 0.5;
// The objects that block the part get the last part of the time, and never less than so long.
constexpr double kBlockersFraction = 0.1, kMinBlockersS = 1;

using SearchWorkers = std::vector<std::unique_ptr<SearchWorker>>;

// Does some work, and ends it in the middle once the clock has come to `end_s`: a single pose can
// take seconds by the meshes. Whether it came to its end.
template <typename Work>
bool until(const SearchRequest& request, double end_s, const Work& work) {
  const exact::Watch watch([&] { return request.clock_s() < end_s; });
  try {
    work();
    return true;
  } catch (const exact::Stopped&) {
    return false;
  }
}

// Takes the path of the first worker that has one which is proven clear. Every worker then avoids
// the poses at which other paths were not.
Status take_proven(const Problem& problem, const SearchWorkers& workers,
                   const SearchRequest& request, double begin_s, SearchResult& result) {
  for (const auto& worker : workers) {
    if (!worker->is_done()) continue;
    if (request.unproven_at) {
      Result<std::optional<Pose>> at = std::optional<Pose>();
      const auto prove = [&] { at = request.unproven_at(worker->in_seat(), worker->beyond()); };
      // A path that is found in time has as long again to be proven.
      if (!until(request, begin_s + 2 * request.max_s, prove)) return {};
      if (!at) return at.error();
      if (*at) {
        ++result.refused;
        result.is_start_refused |= travel_between_m(problem, problem.world_from_start, **at) == 0;
        until(request, begin_s + request.max_s, [&] {
          for (const auto& other : workers) other->refuse(**at);
        });
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

// Takes the shortest path straight along an axis of the world that the meshes prove, or notes what
// is in the way.
Status take_straight(const Problem& problem, const Destination& goal, const SearchRequest& request,
                     double begin_s, SearchResult& result) {
  if (!request.straight_way || goal.is_one_pose()) return {};
  const Pose& start = problem.world_from_start;
  std::vector<std::pair<Pose, glm::dvec3>> ends;
  for (int axis = 0; axis < 6; ++axis) {
    glm::dvec3 direction(0);
    direction[axis / 2] = axis % 2 == 0 ? 1 : -1;
    if (const auto there = goal.straight_from(start, direction)) {
      ends.emplace_back(*there, direction);
    }
  }
  std::stable_sort(ends.begin(), ends.end(), [&](const auto& a, const auto& b) {
    return travel_between_m(problem, start, a.first) < travel_between_m(problem, start, b.first);
  });
  for (const auto& way_out : ends) {
    const Pose& end = way_out.first;
    Result<StraightWay> way = StraightWay();
    const auto ask = [&] { way = request.straight_way(end); };
    if (!until(request, begin_s + kStraightFraction * request.max_s, ask)) return {};
    if (!way) return way.error();
    if (way->is_proven) {
      result.found = true;
      result.beyond = {start, end};
      return {};
    }
    way->direction = way_out.second;
    result.straight.push_back(std::move(*way));
  }
  return {};
}

// The objects that block straight ways: those of the most ways first.
std::vector<std::uint32_t> blockers_of(const std::vector<StraightWay>& ways) {
  std::map<std::uint32_t, std::size_t> times;
  std::vector<std::uint32_t> objects;
  for (const StraightWay& way : ways) {
    for (const std::uint32_t object : way.blocked_by) {
      if (object != 0 && ++times[object] == 1) objects.push_back(object);
    }
  }
  std::stable_sort(objects.begin(), objects.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return times.at(a) > times.at(b); });
  return objects;
}

}  // namespace

double steady_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Result<SearchResult> search(const Problem& problem, const Destination& goal,
                            const SearchRequest& request) {
  const double begin_s = request.clock_s();
  const double end_s = begin_s + (1 - kBlockersFraction) * request.max_s;
  seed_planners(request.seed);
  SearchResult result;
  if (Status s = take_straight(problem, goal, request, begin_s, result); !s) return s.error();
  if (result.found) {
    result.seconds = request.clock_s() - begin_s;
    return result;
  }
  SearchWorkers workers;
  for (std::size_t n = 0; n < kWorkers; ++n) {
    auto check = request.make_check(problem);
    if (!check) return check.error();
    workers.push_back(
        std::make_unique<SearchWorker>(problem, goal, n, request.seed, std::move(*check)));
    if (!until(request, end_s, [&] { workers.back()->begin(); })) break;
  }
  std::mutex reporting;
  const auto report = [&](double now_s) {
    const std::unique_lock lock(reporting, std::try_to_lock);
    if (!lock || !request.progress) return;
    request.progress(std::min(1.0, (now_s - begin_s) / request.max_s), result.out_m);
  };
  // All workers do the same work in a round, so the path does not depend on the clock.
  if (Status s = take_proven(problem, workers, request, begin_s, result); !s) return s.error();
  std::uint64_t round = 0, next_note = 0, last_tested = 0;
  while (!result.found && !result.is_start_refused && !request.is_straight_only &&
         request.clock_s() < end_s) {
    clearance::share_out(std::min<unsigned>(request.threads, kWorkers), workers.size(),
                         [&](std::size_t, std::size_t n) {
                           const auto is_over = [&] {
                             const double now_s = request.clock_s();
                             report(now_s);  // a round may take seconds
                             return now_s >= end_s;
                           };
                           until(request, end_s, [&] { workers[n]->work(kPosesARound, is_over); });
                         });
    const bool notes = ++round >= next_note;
    if (notes) next_note = 2 * round;
    for (const auto& worker : workers) {
      until(request, end_s, [&] {
        worker->take_stock();
        if (notes) worker->note_farthest();
      });
      result.out_m = std::max(result.out_m, worker->out_m());
    }
    if (Status s = take_proven(problem, workers, request, begin_s, result); !s) return s.error();
    // Planners give up at once where the start itself is refused: more time would find nothing.
    std::uint64_t tested = 0;
    for (const auto& worker : workers) tested += worker->poses_tested();
    if (std::exchange(last_tested, tested) == tested) break;
  }
  result.is_out_of_time = !result.found && request.clock_s() >= end_s;
  const double now_s = request.clock_s();
  const double last_s = std::max(begin_s + request.max_s, now_s + kMinBlockersS);
  for (const auto& worker : workers) {
    if (!result.found) until(request, (now_s + last_s) / 2, [&] { worker->note_farthest(); });
    result.out_m = std::max(result.out_m, worker->out_m());
  }
  const auto farthest = std::find_if(workers.begin(), workers.end(), [&](const auto& worker) {
    return worker->out_m() >= result.out_m;
  });
  if (!result.found) {
    result.farthest = (*farthest)->farthest();
    Blockers blockers;
    until(request, last_s, [&] { blockers = (*farthest)->blocked_by(); });
    result.knows_blockers = blockers.is_complete;
    result.blocked_by = blockers_of(result.straight);
    for (const std::uint32_t object : blockers.objects) {
      const auto& known = result.blocked_by;
      if (std::find(known.begin(), known.end(), object) == known.end()) {
        result.blocked_by.push_back(object);
      }
    }
  }
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

#include "workbench/voxplan/search.h"

#include <algorithm>
#include <chrono>
#include <glm/geometric.hpp>
#include <mutex>
#include <utility>

#include "runtime/clearance/share_out.h"
#include "workbench/voxplan/hand.h"

namespace forcelayer::voxplan {
namespace {

constexpr std::uint64_t kPosesARound = 4000;  // of each hand

using Hands = std::vector<std::unique_ptr<Hand>>;

// The way of the first hand that is done and whose way proves clear. What the others learn of ways
// that do not: where.
Status take_proven(const Problem& problem, const Hands& hands, const SearchRequest& request,
                   SearchResult& result) {
  for (const auto& hand : hands) {
    if (!hand->is_done()) continue;
    if (request.unproven_at) {
      const auto at = request.unproven_at(hand->in_seat(), hand->beyond());
      if (!at) return at.error();
      if (*at) {
        ++result.refused;
        result.is_start_refused |= travel_between_m(problem, problem.world_from_start, **at) == 0;
        for (const auto& other : hands) other->refuse(**at);
        continue;
      }
    }
    result.found = true;
    result.in_seat = hand->in_seat();
    result.beyond = hand->beyond();
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
  Hands hands;
  for (std::size_t n = 0; n < kHands; ++n) {
    auto check = request.make_check(problem);
    if (!check) return check.error();
    hands.push_back(std::make_unique<Hand>(problem, goal, n, request.seed, std::move(*check)));
  }
  SearchResult result;
  std::mutex telling;
  const auto tell = [&](double now_s) {
    const std::unique_lock lock(telling, std::try_to_lock);
    if (!lock || !request.progress) return;
    request.progress(std::min(1.0, (now_s - begin_s) / request.max_s), result.out_m);
  };
  // All hands do the same work in a round, so that the clock does not choose the way.
  if (Status s = take_proven(problem, hands, request, result); !s) return s.error();
  std::uint64_t round = 0, next_note = 0, last_tested = 0;
  while (!result.found && !result.is_start_refused && request.clock_s() < end_s) {
    clearance::share_out(std::min<unsigned>(request.threads, kHands), kHands,
                         [&](std::size_t, std::size_t n) {
                           hands[n]->work(kPosesARound, [&] {
                             const double now_s = request.clock_s();
                             tell(now_s);  // a round may take seconds
                             return now_s >= end_s;
                           });
                         });
    const bool notes = ++round >= next_note;
    if (notes) next_note = 2 * round;
    for (const auto& hand : hands) {
      hand->take_stock();
      if (notes) hand->note_farthest();
      result.out_m = std::max(result.out_m, hand->out_m());
    }
    if (Status s = take_proven(problem, hands, request, result); !s) return s.error();
    // Planners give up at once where the start itself is refused: more time would find nothing.
    std::uint64_t tested = 0;
    for (const auto& hand : hands) tested += hand->poses_tested();
    if (std::exchange(last_tested, tested) == tested) break;
  }
  for (const auto& hand : hands) {
    if (!result.found) hand->note_farthest();
    result.out_m = std::max(result.out_m, hand->out_m());
  }
  const auto farthest = std::find_if(
      hands.begin(), hands.end(), [&](const auto& hand) { return hand->out_m() >= result.out_m; });
  if (!result.found) result.blocked_by = (*farthest)->blocked_by();
  for (const auto& hand : hands) {
    result.poses_tested += hand->poses_tested();
    result.motions_tested += hand->motions_tested();
    result.motions_kept += hand->motions_kept();
    result.kept_m += hand->kept_m();
  }
  result.seconds = request.clock_s() - begin_s;
  return result;
}

}  // namespace forcelayer::voxplan

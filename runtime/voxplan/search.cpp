#include "runtime/voxplan/search.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "runtime/clearance/share_out.h"
#include "runtime/voxplan/hand.h"

namespace forcelayer::voxplan {
namespace {

constexpr std::size_t kHands = 4;             // whatever the threads
constexpr std::uint64_t kPosesARound = 4000;  // of each hand

// The way of the first hand that is done. Whether there is one.
bool take_done(const std::vector<std::unique_ptr<Hand>>& hands, SearchResult& result) {
  const auto done =
      std::find_if(hands.begin(), hands.end(), [](const auto& hand) { return hand->is_done(); });
  if (done == hands.end()) return false;
  result.in_seat = (*done)->in_seat();
  result.beyond = (*done)->beyond();
  return true;
}

}  // namespace

Result<SearchResult> search(const Problem& problem, const Destination& goal,
                            const SearchRequest& request) {
  const double begin_s = steady_s(), end_s = begin_s + request.most_s;
  seed_planners(request.seed);
  std::vector<std::unique_ptr<Hand>> hands;
  for (std::size_t n = 0; n < kHands; ++n) {
    auto hand = Hand::create(problem, goal, n, request.seed);
    if (!hand) return hand.error();
    hands.push_back(std::move(*hand));
  }
  SearchResult result;
  // All hands do the same work in a round, so that the clock does not choose the way.
  result.found = take_done(hands, result);
  while (!result.found && steady_s() < end_s) {
    clearance::share_out(std::min<unsigned>(request.threads, kHands), kHands,
                         [&](std::size_t, std::size_t n) { hands[n]->work(kPosesARound, end_s); });
    for (const auto& hand : hands) {
      hand->take_stock();
      result.out_m = std::max(result.out_m, hand->out_m());
    }
    result.found = take_done(hands, result);
    if (request.progress) {
      request.progress(std::min(1.0, (steady_s() - begin_s) / request.most_s), result.out_m);
    }
  }
  for (const auto& hand : hands) {
    if (!result.found && hand->out_m() >= result.out_m) result.blocked_by = hand->blocked_by();
    result.poses_tested += hand->poses_tested();
  }
  result.seconds = steady_s() - begin_s;
  return result;
}

}  // namespace forcelayer::voxplan

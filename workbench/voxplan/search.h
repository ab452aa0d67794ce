// The search for a way: several hands, each with a planner of OMPL, look for it side by side.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "formats/result.h"
#include "workbench/voxplan/check/pose_check.h"
#include "workbench/voxplan/check/problem.h"
#include "workbench/voxplan/destination.h"

namespace forcelayer::voxplan {

double steady_s();  // the steady clock, s

constexpr std::size_t kHands = 4;  // that search side by side, whatever the threads

struct SearchRequest {
  std::uint64_t seed = 1;  // the same way for the same seed, whatever the threads
  unsigned threads = 1;
  double max_s = 60;
  std::function<double()> clock_s = steady_s;  // the clock that limits the search
  // Makes the check of each hand, in the order of their numbers.
  std::function<Result<std::unique_ptr<PoseCheck>>(const Problem&)> make_check = PoseCheck::create;
  // Told in and between rounds, by one thread at a time.
  std::function<void(double fraction_of_time, double out_m)> progress;
  // A pose at which a way that was found does not prove clear: the search goes on for one that does
  // not lead by it, unless it is the start: then all do. None where it proves.
  std::function<Result<std::optional<Pose>>(const Way& in_seat, const Way& beyond)> unproven_at;
};

struct SearchResult {
  bool found = false;
  Way in_seat;  // from the start on, until the clearance is proven; empty where it is at the start
  Way beyond;   // from there to the goal
  // How far from the start the part came, and the objects that refuse motions from there, the most
  // frequent first; those without a name are left out.
  double out_m = 0;
  std::vector<std::uint32_t> blocked_by;
  std::uint64_t poses_tested = 0;
  std::uint64_t motions_tested = 0;
  std::uint64_t motions_kept = 0;  // as a whole
  double kept_m = 0;               // their travel
  std::uint64_t refused = 0;       // ways that did not prove clear
  bool is_start_refused = false;   // none proves clear, at the start itself
  double seconds = 0;
};

// Errors: those of the request's own functions.
Result<SearchResult> search(const Problem& problem, const Destination& goal,
                            const SearchRequest& request);

}  // namespace forcelayer::voxplan

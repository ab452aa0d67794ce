// The search for a way: several hands, each with a planner of OMPL, look for it side by side.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "formats/result.h"
#include "runtime/voxplan/destination.h"
#include "runtime/voxplan/problem.h"

namespace forcelayer::voxplan {

struct SearchRequest {
  std::uint64_t seed = 1;  // the same way for the same seed, whatever the threads
  unsigned threads = 1;
  double most_s = 60;
  std::function<void(double share_of_time, double out_m)> progress;
};

// Poses of the centroid frame; between two of them the part goes straight.
using Way = std::vector<Pose>;

struct SearchResult {
  bool found = false;
  Way in_seat;  // from the start on, until the clearance is proven; empty where it is at the start
  Way beyond;   // from there to the goal
  // How far from the start the part came, and what it met there on its way outward (0: nothing
  // that has a name).
  double out_m = 0;
  std::uint32_t blocked_by = 0;
  std::uint64_t poses_tested = 0;
  double seconds = 0;
};

// Errors: those of PoseCheck::create().
Result<SearchResult> search(const Problem& problem, const Destination& goal,
                            const SearchRequest& request);

}  // namespace forcelayer::voxplan

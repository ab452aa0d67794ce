// One worker of a search: it moves the part out of its seat, and from there to the goal. It uses
// two planners of OMPL in turn. KPIECE explores from the seat, under the rule of the seat. Then
// RRT-Connect grows a tree from both ends, under the rule of the clearance. The first worker tries
// straight motions before.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "workbench/voxplan/check/pose_check.h"
#include "workbench/voxplan/check/problem.h"
#include "workbench/voxplan/destination.h"

namespace forcelayer::voxplan {

// The objects that block the part, and whether the time was enough to find all of them.
struct Blockers {
  std::vector<std::uint32_t> objects;
  bool is_complete = false;
};

// Sets the seed of all random numbers of OMPL. Call it before the first worker is made.
void seed_planners(std::uint64_t seed);

// One thread at a time may call work(). Only the thread that made the workers may call the other
// functions, for one worker after the other in the order of their numbers: OMPL then gives out its
// random numbers in the same order every time.
class SearchWorker {
 public:
  SearchWorker(const Problem& problem, const Destination& goal, std::size_t number,
               std::uint64_t seed, std::unique_ptr<PoseCheck> check);
  ~SearchWorker();

  // Tries the straight motions, or else makes the planner. To be called before all that follows.
  void begin();

  // Tests `poses` more poses. Ends earlier when a path is found or `is_over` returns true.
  void work(std::uint64_t poses, const std::function<bool()>& is_over);
  // To be called after work(): takes over its result. Once the part is out of its seat, the next
  // work() plans on to the goal.
  void take_stock();

  // Finds the farthest pose of all that were explored, for out_m(), farthest() and blocked_by().
  // Slow.
  void note_farthest();

  // From now on no path may pass near this pose, because a path that did was not proven clear. A
  // worker that had found a path starts again.
  void refuse(const Pose& pose);

  bool is_done() const;
  const PosePath& in_seat() const;  // the two pieces of the path, as in SearchResult
  const PosePath& beyond() const;

  // How far the part came from its start, and the objects that block motions from there, the most
  // frequent first. Objects without a name are left out. Where the thread's exact::Watch ends it,
  // those that were met by then.
  double out_m() const;
  const PosePath& farthest() const;  // the path to there, from the start
  Blockers blocked_by() const;

  std::uint64_t poses_tested() const;
  std::uint64_t motions_tested() const;
  std::uint64_t motions_kept() const;
  double kept_m() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace forcelayer::voxplan

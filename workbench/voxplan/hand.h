// One hand: it takes the part out of its seat, and from there to the goal. Two planners of OMPL,
// one after the other: KPIECE, which explores from the seat, under the rule of the seat; then
// RRT-Connect, which grows a tree from either end, under the rule of the clearance. The first hand
// tries straight ways before.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "workbench/voxplan/check/pose_check.h"
#include "workbench/voxplan/check/problem.h"
#include "workbench/voxplan/destination.h"

namespace forcelayer::voxplan {

// All random numbers of OMPL from now on follow from this one. Before the first hand.
void seed_planners(std::uint64_t seed);

// work() is for one thread at a time; all else is for the thread that made all hands, in the order
// of their numbers, so that OMPL hands out its random numbers in one order.
class Hand {
 public:
  Hand(const Problem& problem, const Destination& goal, std::size_t number, std::uint64_t seed,
       std::unique_ptr<PoseCheck> check);
  ~Hand();

  // Tests so many poses more, or until it is done or the time is over.
  void work(std::uint64_t poses, const std::function<bool()>& is_over);
  // Behind work(): takes over what it found. Once out of its seat the part goes on to the goal.
  void take_stock();

  // For out_m() and blocked_by(), by all that was explored, which takes its time.
  void note_farthest();

  // A way that leads by that pose was found, and did not prove clear: none shall. A hand that is
  // done begins anew.
  void refuse(const Pose& pose);

  bool is_done() const;
  const std::vector<Pose>& in_seat() const;  // of the way, as SearchResult has them
  const std::vector<Pose>& beyond() const;

  // How far from the start it came, and the objects that refuse motions from there, the most
  // frequent first; those without a name are left out.
  double out_m() const;
  std::vector<std::uint32_t> blocked_by() const;

  std::uint64_t poses_tested() const;
  std::uint64_t motions_tested() const;
  std::uint64_t motions_kept() const;
  double kept_m() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace forcelayer::voxplan

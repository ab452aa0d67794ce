// The search for a path: several workers, each with its own planners, search side by side.
#pragma once

#include <functional>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "formats/result.h"
#include "workbench/voxplan/check/pose_check.h"
#include "workbench/voxplan/check/problem.h"
#include "workbench/voxplan/destination.h"

namespace forcelayer::voxplan {

double steady_s();  // the steady clock, s

constexpr std::size_t kWorkers = 4;  // does not depend on the number of threads

// A straight way from the start, along an axis of the world.
struct StraightWay {
  glm::dvec3 direction{0};
  bool is_proven = false;  // the whole way is free
  // Where it was seen to be blocked, m from the start, and the objects in the way. Infinite where
  // no such place was seen: then it is not proven to be free.
  double blocked_at_m = std::numeric_limits<double>::infinity();
  std::vector<std::uint32_t> blocked_by;
  // Proven where it meets none of them, but is nearer to the first than required: how far it stays
  // away from them, m.
  double clearance_m = 0;
};

struct SearchRequest {
  std::uint64_t seed = 1;  // one seed gives one path, however many threads there are
  unsigned threads = 1;
  // For the search and, in the last tenth, the objects that block the part. Where that is less than
  // a second, a second more.
  double max_s = 60;
  std::function<double()> clock_s = steady_s;  // the clock that limits the search
  // Called once for each worker, in the order of their numbers.
  std::function<Result<std::unique_ptr<PoseCheck>>(const Problem&)> make_check = PoseCheck::create;
  // Called during and between rounds, by one thread at a time.
  std::function<void(double fraction_of_time, double out_m)> progress;
  // Proves a path that was found. Returns nothing if the path is clear, else a pose at which it is
  // not proven clear. The search then goes on for a path that does not pass near that pose. It ends
  // if that pose is the start, because every path begins there.
  std::function<Result<std::optional<Pose>>(const PosePath& in_seat, const PosePath& beyond)>
      unproven_at;
  // Whether a straight way is free by the meshes, and else what is in the way. Asked before the
  // planners begin, along the axes of the world: the meshes prove more than the files, and what
  // blocks the part does not depend on the voxels. Empty without meshes.
  std::function<Result<StraightWay>(const Pose& end)> straight_way;
  // The files do not prove the start: no planner can begin, and only straight paths are tried.
  bool is_straight_only = false;
};

struct SearchResult {
  bool found = false;
  PosePath in_seat;  // from the start to the first pose with a proven clearance; empty if that is
                     // the start
  PosePath beyond;   // from there to the goal
  // How far the part came from its start, and the objects that block motions from there, the most
  // frequent first. Objects without a name are left out.
  double out_m = 0;
  PosePath farthest;  // the path by which it came there; only that, where none was found
  std::vector<std::uint32_t> blocked_by;
  std::vector<StraightWay> straight;  // those that were asked for in time, where none is free
  bool knows_blockers = true;         // all of them: the time was enough
  bool is_out_of_time = false;        // no path was found before the time was over
  std::uint64_t poses_tested = 0;
  std::uint64_t motions_tested = 0;
  std::uint64_t motions_kept = 0;            // motions that keep their rule from end to end
  double kept_m = 0;                         // the travel of these motions
  std::uint64_t refused = 0;                 // paths that were found but not proven clear
  std::optional<std::uint32_t> enclosed_by;  // the object all around the part: there is no path
  bool is_start_refused = false;             // the start itself was not proven clear
  double seconds = 0;
};

// Errors: those of the request's own functions.
Result<SearchResult> search(const Problem& problem, const Destination& goal,
                            const SearchRequest& request);

}  // namespace forcelayer::voxplan

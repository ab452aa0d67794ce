// The peer: the same planner of OMPL, with FCL's collision of the meshes as its validity test.
#pragma once

#include <cstdint>
#include <memory>

#include "tests/bench/puzzle_bench_puzzles.h"
#include "workbench/voxplan/destination.h"

namespace forcelayer::bench {

// Two meshes as FCL holds them; poses are those of the part's centroid frame.
class MeshValidity {
 public:
  MeshValidity(const Puzzle& puzzle, const voxplan::Problem& problem);
  ~MeshValidity();
  bool is_free(const Pose& world_from_center) const;

 private:
  struct Models;
  std::unique_ptr<Models> models_;
};

// A run of a search, ours or the peer's.
struct Trial {
  bool found = false;
  double seconds = 0;         // of this process' processor time
  std::uint64_t poses = 0;    // tested
  std::uint64_t motions = 0;  // straight ones between two poses, tested as a whole
  std::uint64_t kept = 0;     // of them
  double kept_m = 0;          // their travel
};

// Four RRT-Connect of the ranges that voxplan gives its own, in turns, until one has a way out of
// the scene. Motions are tested in steps of `step_m` of travel.
Trial solve_by_meshes(const Puzzle& puzzle, const voxplan::Problem& problem, double step_m,
                      std::uint64_t seed, double max_s);

}  // namespace forcelayer::bench

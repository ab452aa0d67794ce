// An installed part in a prescribed hand: one that holds still, one that pushes at random, one that
// takes the part out, and one that puts it back. Depth is that of the exact meshes: both solids are
// known as formulas.
#pragma once

#include <cstdint>
#include <string>

#include "tests/stress/installed_pairs.h"

namespace forcelayer::stress {

inline constexpr double kDeepVoxels = 0.1;

// Lengths in voxels.
struct SeatOutcome {
  std::string refused;  // why the start is, if so; then nothing else is known
  // The deepest place of either surface in the other solid, at the start.
  double start_depth = 0;
  double drift = 0;  // the farthest that a shell point went under a hand that holds still
  double still_force_n = 0;
  double depth = 0;       // the most that the part's surface was in the scene, beyond the start
  double edge_depth = 0;  // the same of the scene's sharp edges in the part
  // Under random hands: the deepest of both, and the fraction of the poses in which one of them is
  // deeper than kDeepVoxels.
  double pushed_depth = 0, deep = 0;
  double touching = 0;  // fraction of the poses under random hands in which the meshes meet (FCL)
  bool came_out = false;
  bool tried_back = false;  // the seat was open still
  bool went_back = false;
  double held = 0;  // how far it was moved from its place when it was back
};

// A trial of `push_seconds` of hands at random. The part's shell has a covering radius of
// `covering_voxels`, 0: the usual one. Throws std::runtime_error where it cannot be set up.
SeatOutcome try_seat(const InstalledPair& pair, std::uint64_t seed, double push_seconds,
                     double covering_voxels = 0);

}  // namespace forcelayer::stress

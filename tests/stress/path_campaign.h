// Paths that voxcheck checks, beside the exact distances at many of their moments.
#pragma once

#include <cstdint>
#include <vector>

#include "tests/stress/clearance_cases.h"

namespace forcelayer::stress {

// A moment of a path; lengths in voxels.
struct JudgedMoment {
  double exact = 0;             // between the meshes
  double along = 0;             // proven for the piece of the path around it
  double alone = -1;            // proven for it alone; negative where that was not asked for
  bool premise_failed = false;  // the scene is cropped: nothing is proven beyond its sides
  bool too_much() const { return along > exact + 1e-6 || alone > exact + 1e-6; }
};

struct JudgedPaths {
  std::vector<JudgedMoment> moments;
  // Paths that are 0.1 to 2 voxels too near at one of these moments, and those of them of which
  // voxcheck says so, at that time.
  std::uint64_t planted = 0, found = 0;
};

// `moments` moments of random paths in a scene: what comes near by random lines, sparse rows with
// far ways between them, which may lead through the scene, or dense ones.
JudgedPaths judge_paths(const ClearanceScene& scene, std::uint64_t seed, int moments);

}  // namespace forcelayer::stress

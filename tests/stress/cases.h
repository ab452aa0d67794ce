// The stress cases: scenes, parts and hands that try to break a model.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "tests/stress/trial.h"

namespace forcelayer::stress {

// One family of trials. Equal seeds give equal trials.
struct Case {
  std::string_view name;
  std::string_view what;
  Trial (*make)(std::uint64_t seed);
};

std::span<const Case> all_cases();
const Case& case_named(std::string_view name);  // throws std::out_of_range

// A press and hold of a random part on a random surface: plane, wedge or cone, any orientation.
Trial rest_trial(std::uint64_t seed);
// A slide over an oblique plane, the handle `depth_voxels` below where it touches.
Trial slide_trial(std::uint64_t seed, double depth_voxels);
// A square peg into a square hole whose clearance is `clearance_voxels` beyond the force layers,
// axis and roll oblique to the grid, with a small misalignment. Progress is depth reached over
// depth commanded.
Trial peg_trial(std::uint64_t seed, double clearance_voxels);
// A 15 N press on an oblique plane with voxels of `voxel_size_m`.
Trial press_trial(std::uint64_t seed, double voxel_size_m);

}  // namespace forcelayer::stress

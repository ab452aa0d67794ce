// Clearances of a run's frames at many poses beside the exact ones, and what they come to.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "tests/stress/clearance_cases.h"
#include "tests/stress/clearance_judge.h"

namespace forcelayer::stress {

// A frame that was judged; lengths in voxels.
struct JudgedPose {
  double exact = 0;      // between the meshes
  double claimed = 0;    // 0 where nothing is proven
  double band_end = 0;   // what is claimed where no point is near enough to be measured
  double provable = -1;  // the most that the files prove; negative where it was not computed
  ClearanceKind kind = ClearanceKind::kNone;
  bool premise_failed = false;  // a point at a cropped side or beyond it: nothing is claimed
  bool too_much = false;        // the claim is above the exact distance, or above the provable one
  ObjectVerdict object = ObjectVerdict::kNotTold;
};

// Poses farther apart than this are not kept; nearer than kNear, `provable` is computed.
inline constexpr double kFarVoxels = 8, kNearVoxels = 1.2;

// The frames of a scene's random poses, of the default model, unseated.
std::vector<JudgedPose> judge_scene(const ClearanceScene& scene, std::uint64_t seed, int poses);

// Percentiles of a sample.
struct Spread {
  double median = 0, high = 0, largest = 0;  // 50th and 99th percentile
};
Spread spread_of(std::vector<double> sample);

// Those with from <= exact < to, where a claim is due. `to` of 0: the band's end.
struct ClearanceSummary {
  std::uint64_t poses = 0;
  std::uint64_t without = 0;  // with nothing proven; their slack is the exact distance
  std::uint64_t too_much = 0;
  Spread slack;  // exact less claimed
};
ClearanceSummary summary_of(std::span<const JudgedPose> poses, double from, double to);

struct ObjectSummary {
  std::uint64_t right = 0, wrong = 0, ties = 0;
};
ObjectSummary objects_of(std::span<const JudgedPose> poses);

}  // namespace forcelayer::stress

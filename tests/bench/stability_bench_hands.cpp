// Random hands in congested scenes, the default model.
#include <cstdio>

#include "tests/bench/stability_bench.h"
#include "tests/stress/cases.h"

namespace forcelayer::stress {
namespace {

unsigned long long count(std::uint64_t n) { return n; }

void print(const Metrics& sum) {
  std::printf(
      "  seeds 1-%llu: %llu frames, %llu in the force layer, %llu penetrating, %llu not finite, "
      "%llu over the limits, %llu guard cuts; smallest distance %.3f mm, guaranteed %.3f mm\n",
      count(sum.trials), count(sum.frames), count(sum.force_layer_frames),
      count(sum.penetration_frames), count(sum.non_finite), count(sum.over_limit),
      count(sum.guard_cuts), sum.smallest_distance_m * 1e3, sum.guaranteed_m * 1e3);
  std::fflush(stdout);
}

}  // namespace

Json random_hands(std::uint64_t frames) {
  std::printf("hands that wander through congested scenes, default model\n");
  const Case& hands = case_named("random-hand");
  Metrics sum;
  std::uint64_t shown = 0;
  while (sum.frames < frames) {
    Trial trial = hands.make(sum.trials + 1);
    trial.distance_below_m = sum.smallest_distance_m;
    sum.add(run(trial, Model::kDefault));
    if (sum.frames < shown + 1'000'000) continue;
    shown = sum.frames;
    print(sum);
  }
  print(sum);
  return {{"default", to_json(sum)}};
}

}  // namespace forcelayer::stress

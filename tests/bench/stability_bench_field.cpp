// The paper's model over its field stiffness: its penetration ratio depends on that, and the paper
// does not give it.
#include <cstdio>

#include "tests/bench/stability_bench.h"
#include "tests/stress/collisions.h"

namespace forcelayer::stress {
namespace {

constexpr double kFactors[] = {0.5, 1, 2, 4, 8};  // of the coupling's stiffness

// Collisions until `contact_frames` are counted; the field as derived where `factor` is 0.
Json sweep_row(double factor, std::uint64_t contact_frames) {
  Metrics sum;
  double field_n_per_m = 0;
  for (std::uint64_t seed = 1; sum.force_layer_frames < contact_frames; ++seed) {
    Trial trial = collision_trial(seed);
    trial.exact_distance = false;
    const Parameters derived = open_trial(trial, Model::kPaper).parameters();
    field_n_per_m = factor > 0 ? factor * derived.coupling_n_per_m : derived.field_n_per_m;
    if (factor > 0) trial.settings["field_n_per_m"] = field_n_per_m;
    sum.add(run(trial, Model::kPaper));
  }
  const Interval pr = interval95(sum.penetration_frames, sum.force_layer_frames);
  std::printf("  %-8s %8.0f N/m: PR %.2g (95%%: %.2g to %.2g), generated %.2g J\n",
              factor > 0 ? "" : "derived", field_n_per_m, sum.penetration_ratio(), pr.low, pr.high,
              sum.generated_j);
  std::fflush(stdout);
  return {{"factor", factor > 0 ? Json(factor) : Json(nullptr)},
          {"field_n_per_m", field_n_per_m},
          {"trials", sum.trials},
          {"force_layer_frames", sum.force_layer_frames},
          {"penetrating_trials", sum.penetrating_trials},
          {"penetration_ratio", sum.penetration_ratio()},
          {"ratio_95_low", pr.low},
          {"ratio_95_high", pr.high},
          {"energy_generated_j", sum.generated_j}};
}

}  // namespace

Json field_sweep(std::uint64_t contact_frames) {
  std::printf(
      "field: the paper's model with braking, by its field stiffness over its coupling's\n");
  Json rows = Json::array();
  rows.push_back(sweep_row(0, contact_frames));
  for (const double factor : kFactors) rows.push_back(sweep_row(factor, contact_frames));
  return rows;
}

}  // namespace forcelayer::stress

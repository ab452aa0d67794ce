// Prints every stress case for both models side by side: stress_report [case|all] [trials] [seed]
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/stress/cases.h"

using namespace forcelayer;
using namespace forcelayer::stress;

namespace {

void print(const char* model, const Metrics& m) {
  std::printf(
      "  %-7s frames %llu in layer %llu PR %.2g (%llu) inside-starts %llu cuts %llu sat %.2f | "
      "peak %.2f N rest p50 %.2f "
      "| cycle p50 %.2g p99 %.2g vox growth %.2g settle p50 %.3g max %.3g s hz %.0f | gen %.2g "
      "worst %.2g J "
      "| progress p10 %.3f p50 %.3f stuck %.3f | step p50 %.2g p99 %.2g N | dist %.4g guar %.4f mm "
      "(%llu/%llu) | lag %.3g | "
      "nan %llu over %llu\n",
      model, (unsigned long long)m.frames, (unsigned long long)m.force_layer_frames,
      m.penetration_ratio(), (unsigned long long)m.penetration_frames,
      (unsigned long long)m.starts_inside, (unsigned long long)m.guard_cuts,
      double(m.saturated_frames) / double(m.frames + 1), m.peak_force_n,
      percentile(m.rest_force_n, 50), percentile(m.cycle_voxels, 50),
      percentile(m.cycle_voxels, 99), percentile(m.cycle_growth_voxels, 100),
      percentile(m.settle_s, 50), percentile(m.settle_s, 100), percentile(m.cycle_hz, 50),
      m.generated_j, m.worst_generated_j, percentile(m.progress, 10), percentile(m.progress, 50),
      percentile(m.stuck_share, 50), percentile(m.force_steps_n, 50),
      percentile(m.force_steps_n, 99), m.smallest_distance_m * 1e3, m.guaranteed_m * 1e3,
      (unsigned long long)m.distances_measured, (unsigned long long)m.distances_visited,
      percentile(m.lag_m, 100), (unsigned long long)m.non_finite, (unsigned long long)m.over_limit);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string which = argc > 1 ? argv[1] : "all";
  const int trials = argc > 2 ? std::atoi(argv[2]) : 5;
  const int first = argc > 3 ? std::atoi(argv[3]) : 1;
  const bool exact = argc <= 4 || std::atoi(argv[4]) != 0;
  for (const Case& c : all_cases()) {
    if (which != "all" && which != c.name) continue;
    std::printf("%s: %s\n", std::string(c.name).c_str(), std::string(c.what).c_str());
    for (const Model model : {Model::kPaper, Model::kDefault}) {
      Metrics sum;
      for (int i = 0; i < trials; ++i) {
        Trial trial = c.make(static_cast<std::uint64_t>(first + i));
        trial.exact_distance = exact;
        sum.add(run(trial, model));
      }
      print(model == Model::kPaper ? "paper" : "default", sum);
    }
  }
}

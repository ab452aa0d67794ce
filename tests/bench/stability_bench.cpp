// Stability of both models side by side:
//   stability_bench cases [TRIALS]   every stress case, paper beside default
//   stability_bench table2 [TRIALS]  the paper's Table 2, beside default
//   stability_bench map              stable and unstable settings: stiffness, mass and rate
//   stability_bench device           the same with a simulated hand and device, beside the bound
// Seeds run from 1. Without an argument: all four, small.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <string>

#include "runtime/devices/sim_hand.h"
#include "runtime/handle_velocity.h"
#include "runtime/stability.h"
#include "tests/bench/bench_report.h"
#include "tests/stress/cases.h"

namespace forcelayer::stress {
namespace {

using Json = nlohmann::ordered_json;

const char* name_of(Model model) { return model == Model::kPaper ? "paper" : "default"; }

Json to_json(const Metrics& m) {
  const Interval pr = interval95(m.penetration_frames, m.force_layer_frames);
  return Json{{"trials", m.trials},
              {"starts_inside", m.starts_inside},
              {"frames", m.frames},
              {"force_layer_frames", m.force_layer_frames},
              {"penetration_frames", m.penetration_frames},
              {"penetration_ratio", m.penetration_ratio()},
              {"penetration_ratio_95", {pr.low, pr.high}},
              {"guard_cuts", m.guard_cuts},
              {"peak_force_n", m.peak_force_n},
              {"rest_force_n_p50", percentile(m.rest_force_n, 50)},
              {"cycle_voxels_p99", percentile(m.cycle_voxels, 99)},
              {"cycle_force_n_p99", percentile(m.cycle_force_n, 99)},
              {"cycle_hz_p50", percentile(m.cycle_hz, 50)},
              {"settle_s_p50", percentile(m.settle_s, 50)},
              {"settle_s_max", percentile(m.settle_s, 100)},
              {"energy_generated_j_worst", m.worst_generated_j},
              {"progress_p10", percentile(m.progress, 10)},
              {"progress_p50", percentile(m.progress, 50)},
              {"stuck_share_p50", percentile(m.stuck_share, 50)},
              {"force_step_n_p50", percentile(m.force_steps_n, 50)},
              {"force_step_n_p99", percentile(m.force_steps_n, 99)},
              {"smallest_distance_m", m.smallest_distance_m},
              {"guaranteed_m", m.guaranteed_m},
              {"lag_m_max", percentile(m.lag_m, 100)},
              {"non_finite_frames", m.non_finite},
              {"over_limit_frames", m.over_limit}};
}

Metrics sum_of(const Case& c, Model model, std::uint64_t trials, bool exact) {
  Metrics sum;
  for (std::uint64_t seed = 1; seed <= trials; ++seed) {
    Trial trial = c.make(seed);
    trial.exact_distance = exact;
    sum.add(run(trial, model));
  }
  return sum;
}

void print_row(const char* model, const Metrics& m) {
  std::printf("  %-8s%9.2g%8llu%9.2f%9.2g%9.3f%10.2g%9.3f%7.2f%9.2g%10.3f%9.3f\n", model,
              m.penetration_ratio(), static_cast<unsigned long long>(m.guard_cuts), m.peak_force_n,
              percentile(m.cycle_voxels, 99), percentile(m.settle_s, 100), m.worst_generated_j,
              percentile(m.progress, 10), percentile(m.stuck_share, 50),
              percentile(m.force_steps_n, 99), m.smallest_distance_m * 1e3, m.guaranteed_m * 1e3);
  std::fflush(stdout);
}

Json cases(std::uint64_t trials) {
  Json report;
  std::printf("  %-8s%9s%8s%9s%9s%9s%10s%9s%7s%9s%10s%9s\n", "model", "PR", "cuts", "peak N",
              "cycle", "settle s", "gener. J", "progress", "stuck", "step N", "dist mm", "guar mm");
  for (const Case& c : all_cases()) {
    std::printf("%s: %s\n", std::string(c.name).c_str(), std::string(c.what).c_str());
    for (const Model model : {Model::kPaper, Model::kDefault}) {
      const Metrics m = sum_of(c, model, trials, c.name != "nut-on-bolt");
      print_row(name_of(model), m);
      report[std::string(c.name)][name_of(model)] = to_json(m);
    }
  }
  return report;
}

// Collisions and congestion in the spirit of the paper's test: 6.4, Table 2.
Json table2(std::uint64_t trials) {
  Json report;
  std::printf(
      "Table 2 (%llu trials each of random-hand, shaking-hand, two-surfaces, slide-plane)\n",
      static_cast<unsigned long long>(trials));
  for (const auto& [title, model, braking] : {std::tuple{"paper, no braking", Model::kPaper, false},
                                              std::tuple{"paper, braking", Model::kPaper, true},
                                              std::tuple{"default", Model::kDefault, true}}) {
    Metrics sum;
    for (const char* name : {"random-hand", "shaking-hand", "two-surfaces", "slide-plane"}) {
      for (std::uint64_t seed = 1; seed <= trials; ++seed) {
        Trial trial = case_named(name).make(seed);
        trial.exact_distance = false;
        trial.braking = braking;
        sum.add(run(trial, model));
      }
    }
    const Interval pr = interval95(sum.penetration_frames, sum.force_layer_frames);
    std::printf("  %-18s penetrations %8llu contacts %9llu PR %.2g (95%%: %.2g to %.2g)\n", title,
                static_cast<unsigned long long>(sum.penetration_frames),
                static_cast<unsigned long long>(sum.force_layer_frames), sum.penetration_ratio(),
                pr.low, pr.high);
    std::fflush(stdout);
    report[title] = to_json(sum);
  }
  return report;
}

// Quiet '.', moving but neither growing nor beyond the limits '~', unstable 'X'.
char verdict(const Metrics& m) {
  if (m.non_finite > 0 || m.over_limit > 0) return 'X';
  const double cycle = percentile(m.cycle_voxels, 100);
  if (percentile(m.cycle_growth_voxels, 100) > 0.1 * cycle && cycle > 0.01) return 'X';
  return cycle < 1e-6 ? '.' : '~';
}

Json map() {
  Json report;
  std::printf(
      "map: a part pressed and held; . quiet, ~ moves, X unstable; rows mass, columns k_T\n");
  for (const Model model : {Model::kPaper, Model::kDefault}) {
    for (const double rate_hz : {100.0, 1000.0, 10000.0}) {
      std::printf("%s at %g Hz       k_T = 10 100 1e3 1e4 1e5 1e6 N/m\n", name_of(model), rate_hz);
      for (double mass_kg = 0.001; mass_kg < 200; mass_kg *= 10) {
        std::string row;
        for (double stiffness = 10; stiffness < 2e6; stiffness *= 10) {
          Trial trial = rest_trial(7);
          trial.exact_distance = false;
          trial.rate_hz = rate_hz;
          trial.settings = {{"mass_kg", mass_kg}, {"coupling_n_per_m", stiffness}};
          row += verdict(run(trial, model));
        }
        std::printf("  %8g kg  %s\n", mass_kg, row.c_str());
        std::fflush(stdout);
        report[name_of(model)][std::to_string(rate_hz)][std::to_string(mass_kg)] = row;
      }
    }
  }
  return report;
}

// Peak to peak of the handle in the last second of a press by a simulated hand, m.
double device_ripple_m(Model model, double stiffness_n_per_m, const SimHandParameters& hand) {
  Trial trial = press_trial(3, 0.005);
  trial.settings["coupling_n_per_m"] = stiffness_n_per_m;
  trial.device.delay_s = hand.delay_s;
  const auto simulation = make_simulation(trial, model);
  const double dt_s = 1 / trial.rate_hz;
  const Pose start = trial.target(0), pressed = trial.target(1);
  const glm::dvec3 down = glm::normalize(pressed.position_m - start.position_m);
  // Wanted: until contact, then 10 mm further.
  State state = simulation->registered(trial.start, trial.start);
  SimHand device(hand, start.position_m);
  HandleVelocity velocity;
  StepInput input;
  input.valid = 1;
  input.world_from_handle = start;
  glm::dvec3 force_n(0), wanted_m = start.position_m, low(1e300), high(-1e300);
  bool touched = false;
  for (int frame = 0; frame < 5000; ++frame) {
    if (!touched) wanted_m += down * 0.1 * dt_s;
    const glm::dvec3 goal_m = touched ? wanted_m + down * 0.01 : wanted_m;
    input.world_from_handle.position_m = device.step(goal_m, force_n, dt_s);
    input.handle_velocity = velocity.update(input.world_from_handle, dt_s);
    const StepResult result = simulation->step(state, input, dt_s);
    force_n = result.wrench.force_n;
    touched |= result.report.contacts > 0;
    if (frame < 4000) continue;
    low = glm::min(low, device.position_m());
    high = glm::max(high, device.position_m());
  }
  return glm::length(high - low);
}

// A hand that lets the device swing: the light device with a loose grip is the worst case.
Json device() {
  Json report;
  constexpr double kRippleM = 2e-4;  // eight encoder steps: below, what is left is quantisation
  std::printf("device loop at 1 kHz: stiffest quiet coupling (N/m), beside b / (delay + T/2)\n");
  for (const Model model : {Model::kPaper, Model::kDefault}) {
    for (const double delay_s : {0.0, 0.001, 0.002, 0.003}) {
      for (const bool loose : {true, false}) {
        SimHandParameters hand;
        hand.delay_s = delay_s;
        if (loose)
          hand.hand_mass_kg = 0, hand.hand_damping_ns_per_m = 0, hand.hand_stiffness_n_per_m = 50;
        double stiffest = 0;
        for (double k = 100; k < 40000; k *= std::sqrt(2.0)) {
          if (device_ripple_m(model, k, hand) > kRippleM) break;
          stiffest = k;
        }
        const double b = hand.device_damping_ns_per_m + hand.hand_damping_ns_per_m;
        const double bound = renderable_stiffness(b, delay_s, 0.001);
        std::printf("  %-8s delay %g ms %-6s quiet up to %6.0f, bound %6.0f\n", name_of(model),
                    delay_s * 1e3, loose ? "loose" : "firm", stiffest, bound);
        std::fflush(stdout);
        report[name_of(model)].push_back({{"delay_s", delay_s},
                                          {"loose", loose},
                                          {"quiet_n_per_m", stiffest},
                                          {"bound_n_per_m", bound}});
      }
    }
  }
  return report;
}

}  // namespace
}  // namespace forcelayer::stress

int main(int argc, char** argv) {
  using namespace forcelayer::stress;
  const std::string what = argc > 1 ? argv[1] : "all";
  const auto trials = static_cast<std::uint64_t>(argc > 2 ? std::atoi(argv[2]) : 3);
  try {
    forcelayer::stress::Json results;
    if (what == "all" || what == "cases") results["cases"] = cases(trials);
    if (what == "all" || what == "table2") results["table2"] = table2(trials);
    if (what == "all" || what == "map") results["map"] = map();
    if (what == "all" || what == "device") results["device"] = device();
    if (results.empty()) {
      std::fprintf(stderr, "stability_bench: cases, table2, map or device, not %s\n", what.c_str());
      return 2;
    }
    const std::string path = argc > 3 ? argv[3] : "stability.json";
    forcelayer::bench::write_report("stability", argc, argv, results, path);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "stability_bench: %s\n", error.what());
    return 1;
  }
}

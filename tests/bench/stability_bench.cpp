// Stability of both models side by side:
//   stability_bench cases [TRIALS]    every stress case (3 trials each)
//   stability_bench rest [TRIALS]     random rest trials (500)
//   stability_bench table2 [FRAMES]   the paper's Table 2, beside default (1000000 contact frames)
//   stability_bench field [FRAMES]    the paper's model by its field stiffness (1000000 each)
//   stability_bench hands [FRAMES]    hands of every temper in congested scenes (20000000)
//   stability_bench map               stable and unstable settings: stiffness, mass and rate
//   stability_bench device            the loop closed by a simulated hand and device
//   stability_bench grips [MODEL [SCALE]]   handles that hold the part aside of its centroid
//   stability_bench loops [above|seated [SCALE]]   what closed loops in contact give the hand, at
//                                     every scale
//   stability_bench seats [PAIRS [FIRST]]   parts that start installed (203, from pair 0 on)
//   stability_bench step [STEPS]      cost of a step with 200 contacts and more (100000)
//   stability_bench all               all of them
// Each writes stability_NAME.json (bench_report.h); --json FILE writes another file. Seeds run from
// 1. `scripts/bench.sh stability motion` draws the plots too.
#include "tests/bench/stability_bench.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <string>

#include "tests/bench/bench_report.h"
#include "tests/stress/cases.h"
#include "tests/stress/collisions.h"

namespace forcelayer::stress {
namespace {

double largest(const std::vector<double>& sample) { return percentile(sample, 100); }

unsigned long long count(std::uint64_t n) { return n; }

void print_header() {
  std::printf("  %-8s%8s%7s%8s%8s%9s%9s%9s%9s%9s%6s%8s%8s%9s%8s%8s%6s\n", "model", "PR", "cuts",
              "peak N", "rest N", "cycle vx", "cycle Hz", "settle s", "gener. J", "progress",
              "stuck", "step50", "step99", "dist mm", "guar mm", "lag mm", "NaN");
}

// A number of the table, with a blank before it. A run that has overflowed says nothing by its
// digits: what no device and no scene has is ">1e6".
std::string cell(int width, const char* format, double value) {
  char digits[64];
  std::snprintf(digits, sizeof digits, std::abs(value) < 1e6 ? format : ">1e6", value);
  char text[80];
  std::snprintf(text, sizeof text, "%*s", width, digits);
  return text;
}

void print_row(const char* model, const Metrics& m) {
  const bool measured = m.distances_visited > 0;
  const std::string cells[] = {
      cell(8, "%.1g", m.penetration_ratio()),
      cell(7, "%.0f", static_cast<double>(m.guard_cuts)),
      cell(8, "%.2f", m.peak_force_n),
      cell(8, "%.2f", percentile(m.rest_force_n, 50)),
      cell(9, "%.1e", largest(m.cycle_voxels)),
      cell(9, "%.3g", percentile(m.cycle_hz, 50)),
      cell(9, "%.3f", largest(m.settle_s)),
      cell(9, "%.1e", m.worst_generated_j),
      cell(9, "%.3f", percentile(m.progress, 10)),
      cell(6, "%.2f", percentile(m.stuck_share, 50)),
      cell(8, "%.1e", percentile(m.force_steps_n, 50)),
      cell(8, "%.1e", percentile(m.force_steps_n, 99)),
      measured ? cell(9, "%.3f", m.smallest_distance_m * 1e3) : cell(9, "-", 0),
      cell(8, "%.3f", m.guaranteed_m * 1e3),
      cell(8, "%.1f", largest(m.lag_m) * 1e3),
      cell(6, "%.0f", static_cast<double>(m.non_finite))};
  std::printf("  %-8s", model);
  for (const std::string& text : cells) std::printf("%s", text.c_str());
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace

Json to_json(const Metrics& m) {
  const Interval pr = interval95(m.penetration_frames, m.force_layer_frames);
  const bool measured = m.distances_visited > 0;
  return Json{{"trials", m.trials},
              {"starts_inside", m.starts_inside},
              {"frames", m.frames},
              {"force_layer_frames", m.force_layer_frames},
              {"penetration_frames", m.penetration_frames},
              {"penetrating_trials", m.penetrating_trials},
              {"penetration_ratio", m.penetration_ratio()},
              {"penetration_ratio_95", {pr.low, pr.high}},
              {"guard_cuts", m.guard_cuts},
              {"guard_cut_share", static_cast<double>(m.guard_cuts) /
                                      static_cast<double>(std::max<std::uint64_t>(1, m.frames))},
              {"peak_force_n", m.peak_force_n},
              {"peak_torque_nm", m.peak_torque_nm},
              {"rest_force_n_p50", percentile(m.rest_force_n, 50)},
              {"cycle_voxels_p99", percentile(m.cycle_voxels, 99)},
              {"cycle_voxels_max", largest(m.cycle_voxels)},
              {"cycle_force_n_max", largest(m.cycle_force_n)},
              {"cycle_hz_p50", percentile(m.cycle_hz, 50)},
              {"settle_s_p50", percentile(m.settle_s, 50)},
              {"settle_s_max", largest(m.settle_s)},
              {"energy_generated_j", m.generated_j},
              {"energy_generated_j_worst", m.worst_generated_j},
              {"progress_p10", percentile(m.progress, 10)},
              {"progress_p50", percentile(m.progress, 50)},
              {"stuck_share_p50", percentile(m.stuck_share, 50)},
              {"force_step_n_p50", percentile(m.force_steps_n, 50)},
              {"force_step_n_p99", percentile(m.force_steps_n, 99)},
              {"approach_mps_p50", percentile(m.approach_mps, 50)},
              {"approach_mps_p95", percentile(m.approach_mps, 95)},
              {"approach_mps_max", largest(m.approach_mps)},
              {"smallest_distance_m", measured ? Json(m.smallest_distance_m) : Json(nullptr)},
              {"guaranteed_m", m.guaranteed_m},
              {"distances_visited", m.distances_visited},
              {"distances_measured", m.distances_measured},
              {"lag_m_max", largest(m.lag_m)},
              {"non_finite_frames", m.non_finite},
              {"overflow_frames", m.overflows},
              {"over_limit_frames", m.over_limit}};
}

Json case_table(std::uint64_t trials) {
  Json report;
  print_header();
  for (const Case& c : all_cases()) {
    std::printf("%s: %s\n", std::string(c.name).c_str(), std::string(c.what).c_str());
    for (const Model model : kBothModels) {
      Metrics sum;
      for (std::uint64_t seed = 1; seed <= trials; ++seed) sum.add(run(c.make(seed), model));
      print_row(name_of(model), sum);
      report[std::string(c.name)][name_of(model)] = to_json(sum);
    }
  }
  return report;
}

Json rest_table(std::uint64_t trials) {
  Json report;
  std::printf("rest: quiet is below 1e-6 voxel and 1e-6 N peak to peak\n");
  print_header();
  for (const Model model : kBothModels) {
    Metrics sum;
    std::uint64_t quiet = 0;
    std::vector<std::uint64_t> restless;  // seeds
    for (std::uint64_t seed = 1; seed <= trials; ++seed) {
      Trial trial = rest_trial(seed);
      trial.exact_distance = false;
      trial.rest_place = true;
      const Metrics m = run(trial, model);
      if (largest(m.cycle_voxels) < 1e-6 && largest(m.cycle_force_n) < 1e-6) {
        ++quiet;
      } else {
        restless.push_back(seed);
      }
      sum.add(m);
    }
    print_row(name_of(model), sum);
    std::printf("           quiet %llu of %llu", count(quiet), count(trials));
    if (!restless.empty()) std::printf(", first not quiet: seed %llu", count(restless[0]));
    Json row = to_json(sum);
    if (!sum.place_error_voxels.empty()) {
      const auto near = static_cast<std::uint64_t>(
          std::count_if(sum.place_error_voxels.begin(), sum.place_error_voxels.end(),
                        [](double voxels) { return voxels <= 0.25; }));
      const bench::Percentiles error = bench::percentiles(sum.place_error_voxels);
      std::printf("; %llu within 0.25 voxel of where the energy is least, p50 %.3f, p99 %.3f",
                  count(near), error.p50, error.p99);
      row["within_quarter_voxel"] = near;
      row["place_error_voxels"] = bench::to_json(error);
    }
    std::printf("\n");
    row["restless_seeds"] = restless;
    row["quiet"] = quiet;
    row["quiet_share"] =
        static_cast<double>(quiet) / static_cast<double>(std::max<std::uint64_t>(1, trials));
    report[name_of(model)] = row;
  }
  return report;
}

namespace {

struct Table2Row {
  const char* title;
  Model model;
  bool braking;
  Metrics sum;
};

void print_row(const Table2Row& row) {
  const Metrics& m = row.sum;
  const Interval pr = interval95(m.penetration_frames, m.force_layer_frames);
  std::printf(
      "  %-18s penetrations %8llu contacts %9llu PR %.2g (95%%: %.2g to %.2g) seeds 1-%llu\n"
      "%21sspeed at contact p50 %.2f p95 %.2f max %.2f m/s; guard cuts %llu; in %llu frames",
      row.title, count(m.penetration_frames), count(m.force_layer_frames), m.penetration_ratio(),
      pr.low, pr.high, count(m.trials), "", percentile(m.approach_mps, 50),
      percentile(m.approach_mps, 95), largest(m.approach_mps), count(m.guard_cuts),
      count(m.frames));
  if (m.distances_visited > 0) {
    std::printf("; smallest distance %.3f mm, guaranteed %.3f mm", m.smallest_distance_m * 1e3,
                m.guaranteed_m * 1e3);
  }
  std::printf("\n");
}

}  // namespace

Json table2(std::uint64_t contact_frames) {
  std::printf(
      "Table 2: a pump of 75 mm struck against a bay by a simulated hand (15 N, 0.1 N m)\n");
  Table2Row rows[] = {{"paper, no braking", Model::kPaper, false, {}},
                      {"paper, braking", Model::kPaper, true, {}},
                      {"default", Model::kDefault, true, {}}};
  // The same hands for all three, until each has its frames.
  std::uint64_t least = 0;
  for (std::uint64_t seed = 1; least < contact_frames; ++seed) {
    Trial trial = collision_trial(seed);
    least = UINT64_MAX;
    for (Table2Row& row : rows) {
      trial.braking = row.braking;
      trial.exact_distance = row.model == Model::kDefault;
      trial.distance_below_m = row.sum.smallest_distance_m;
      row.sum.add(run(trial, row.model));
      least = std::min(least, row.sum.force_layer_frames);
    }
  }
  Json report;
  report["paper's own"] = {{"no braking", {{"penetrations", 70}, {"contacts", 69000}}},
                           {"braking", {{"penetrations", 6}, {"contacts", 108000}}}};
  for (const Table2Row& row : rows) {
    print_row(row);
    report[row.title] = to_json(row.sum);
  }
  return report;
}

namespace {

// A part pressed into place and held for twenty times what the coupling needs to get there, and
// twenty times what its largest force does: what a heavy part on a soft or weak coupling does in
// two seconds is on its way, and says nothing of stability.
Trial map_trial(double mass_kg, double stiffness_n_per_m, double rate_hz) {
  Trial trial = rest_trial(7);
  trial.exact_distance = false;
  trial.rate_hz = rate_hz;
  trial.settings = {{"mass_kg", mass_kg}, {"coupling_n_per_m", stiffness_n_per_m}};
  const double way_m = 0.3, force_n = trial.device.max_force_n;
  const double hold_s = std::max({2.0, 20 * std::sqrt(mass_kg / stiffness_n_per_m),
                                  20 * std::sqrt(2 * way_m * mass_kg / force_n)});
  trial.duration_s = *trial.hold_from_s + hold_s;
  return trial;
}

// Quiet '.'; moving, but less and less '~'; X: overflowing, or moving as much as before or more.
char verdict(const Metrics& m) {
  if (m.non_finite + m.overflows > 0) return 'X';
  const double earlier = largest(m.swing_third_voxels), later = largest(m.swing_last_voxels);
  if (later < 1e-6) return '.';
  return later < 0.9 * earlier ? '~' : 'X';
}

}  // namespace

Json setting_map() {
  Json report;
  std::printf("map: a part pressed and held; . quiet, ~ moves less and less, X does not calm\n");
  for (const Model model : kBothModels) {
    for (const double rate_hz : {100.0, 1000.0, 10000.0}) {
      std::printf("%s at %g Hz       k_T = 10 100 1e3 1e4 1e5 1e6 N/m\n", name_of(model), rate_hz);
      Json rows = Json::array();
      for (int mass = -3; mass <= 2; ++mass) {
        std::string row;
        for (int stiffness = 1; stiffness <= 6; ++stiffness) {
          row +=
              verdict(run(map_trial(std::pow(10, mass), std::pow(10, stiffness), rate_hz), model));
        }
        std::printf("  %8g kg  %s\n", std::pow(10, mass), row.c_str());
        std::fflush(stdout);
        rows.push_back({{"mass_kg", std::pow(10, mass)}, {"cells", row}});
      }
      report[name_of(model)].push_back({{"rate_hz", rate_hz}, {"rows", rows}});
    }
  }
  return report;
}

namespace {

int run_tables(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  std::string path;
  if (words.size() >= 2 && words[words.size() - 2] == "--json") {
    path = words.back();
    words.resize(words.size() - 2);
  }
  const std::string what = words.empty() ? "all" : words[0];
  const auto amount = [&](std::uint64_t usual) -> std::uint64_t {
    return words.size() > 1 ? std::strtoull(words[1].c_str(), nullptr, 10) : usual;
  };
  const std::pair<const char*, std::function<Json()>> tables[] = {
      {"cases", [&] { return case_table(amount(3)); }},
      {"rest", [&] { return rest_table(amount(500)); }},
      {"table2", [&] { return table2(amount(1'000'000)); }},
      {"field", [&] { return field_sweep(amount(1'000'000)); }},
      {"hands", [&] { return random_hands(amount(20'000'000)); }},
      {"map", setting_map},
      {"device", device_table},
      {"grips",
       [&] {
         return grip_map(words.size() > 1 ? words[1] : "",
                         words.size() > 2 ? std::stod(words[2]) : 0);
       }},
      {"loops",
       [&] {
         return loop_table(words.size() > 1 ? words[1] : "",
                           words.size() > 2 ? std::stod(words[2]) : 0);
       }},
      {"seats",
       [&] {
         return seat_table(amount(203), words.size() > 2 ? std::stoull(words[2]) : 0,
                           words.size() > 3 ? std::stod(words[3]) : 0);
       }},
      {"step", [&] { return step_cost(amount(100'000)); }}};
  bool known = false;
  for (const auto& [name, table] : tables) {
    if (what != "all" && what != name) continue;
    known = true;
    bench::write_report(std::string("stability_") + name, argc, argv, table(), path);
  }
  if (known) return 0;
  std::fprintf(stderr, "stability_bench: no table is called %s\n", what.c_str());
  return 2;
}

}  // namespace
}  // namespace forcelayer::stress

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("stability_bench", forcelayer::stress::run_tables, argc,
                                          argv);
}

// Stability of both models side by side:
//   stability_bench cases [TRIALS]    every stress case (3 trials each)
//   stability_bench rest [TRIALS]     presses that are held (500)
//   stability_bench table2 [FRAMES]   the paper's Table 2, beside default (1000000 contact frames)
//   stability_bench field [FRAMES]    the paper's model by the stiffness of its field (1000000)
//   stability_bench seats [PAIRS]     parts that start installed (203)
//   stability_bench grips             handles that hold the part aside of its centroid
//   stability_bench step [STEPS]      the time of a step with 200 contacts and more (100000)
//   stability_bench drift [FRAMES]    free flight (10000000)
// Seeds run from 1, of seats from 0.
#include "tests/bench/stability_bench.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <string>

#include "runtime/model/rigid_body.h"
#include "tests/bench/bench_report.h"
#include "tests/stress/cases.h"
#include "tests/stress/collisions.h"
#include "tests/stress/seat_trial.h"
#include "tests/support/motion_bench.h"

namespace forcelayer::stress {
namespace {

double largest(const std::vector<double>& sample) { return percentile(sample, 100); }

unsigned long long count(std::uint64_t n) { return n; }

// The row of a campaign, and its line on the terminal.
Json row_of(const char* campaign, std::string_view name, const char* model, const Metrics& m) {
  const Interval ratio = interval95(m.penetration_frames, m.force_layer_frames);
  const bool measured = m.distances_visited > 0;
  std::printf(
      "  %-16s %-17s %llu of %llu contact frames penetrate (95%%: %.2g to %.2g), in %llu of %llu "
      "trials; energy %.2g J; progress %.3f; stuck %.2f; nearest %.3f mm, proven %.3f mm; not "
      "finite %llu\n",
      std::string(name).c_str(), model, count(m.penetration_frames), count(m.force_layer_frames),
      ratio.low, ratio.high, count(m.penetrating_trials), count(m.trials), m.worst_generated_j,
      percentile(m.progress, 10), percentile(m.stuck_fraction, 50),
      measured ? m.smallest_distance_m * 1e3 : NAN, m.guaranteed_m * 1e3, count(m.non_finite));
  std::fflush(stdout);
  return {{"campaign", campaign},
          {"case", name},
          {"model", model},
          {"trials", m.trials},
          {"frames", m.frames},
          {"force_layer_frames", m.force_layer_frames},
          {"penetration_frames", m.penetration_frames},
          {"penetrating_trials", m.penetrating_trials},
          {"penetration_ratio", m.penetration_ratio()},
          {"ratio_95_low", ratio.low},
          {"ratio_95_high", ratio.high},
          {"quiet", nullptr},
          {"quiet_fraction", nullptr},
          {"energy_generated_j_worst", m.worst_generated_j},
          {"progress_p10", percentile(m.progress, 10)},
          {"stuck_fraction_p50", percentile(m.stuck_fraction, 50)},
          {"smallest_distance_m", measured ? Json(m.smallest_distance_m) : Json(nullptr)},
          {"guaranteed_m", m.guaranteed_m},
          {"non_finite_frames", m.non_finite}};
}

Json case_table(std::uint64_t trials) {
  Json rows = Json::array();
  for (const Case& c : all_cases()) {
    for (const Model model : kBothModels) {
      Metrics sum;
      for (std::uint64_t seed = 1; seed <= trials; ++seed) sum.add(run(c.make(seed), model));
      rows.push_back(row_of("cases", c.name, name_of(model), sum));
    }
  }
  return rows;
}

// Quiet is below 1e-6 voxel and 1e-6 N peak to peak.
Json rest_table(std::uint64_t trials) {
  Json rows = Json::array();
  for (const Model model : kBothModels) {
    Metrics sum;
    std::uint64_t quiet = 0;
    for (std::uint64_t seed = 1; seed <= trials; ++seed) {
      Trial trial = rest_trial(seed);
      trial.exact_distance = false;
      const Metrics m = run(trial, model);
      quiet += largest(m.cycle_voxels) < 1e-6 && largest(m.cycle_force_n) < 1e-6;
      sum.add(m);
    }
    Json row = row_of("rest", "rest", name_of(model), sum);
    row["quiet"] = quiet;
    row["quiet_fraction"] =
        static_cast<double>(quiet) / static_cast<double>(std::max<std::uint64_t>(1, trials));
    std::printf("    quiet %llu of %llu\n", count(quiet), count(trials));
    rows.push_back(std::move(row));
  }
  return rows;
}

// A pump of 75 mm is struck against a bay by a simulated hand (15 N, 0.1 N m).
Json table2(std::uint64_t contact_frames) {
  struct Contestant {
    const char* title;
    Model model;
    bool braking;
    Metrics sum;
  };
  Contestant all[] = {{"paper, no braking", Model::kPaper, false, {}},
                      {"paper, braking", Model::kPaper, true, {}},
                      {"default", Model::kDefault, true, {}}};
  // The same hands for all three, until each has its frames.
  std::uint64_t smallest = 0;
  for (std::uint64_t seed = 1; smallest < contact_frames; ++seed) {
    Trial trial = collision_trial(seed);
    smallest = UINT64_MAX;
    for (Contestant& one : all) {
      trial.braking = one.braking;
      trial.exact_distance = one.model == Model::kDefault;
      trial.distance_below_m = one.sum.smallest_distance_m;
      one.sum.add(run(trial, one.model));
      smallest = std::min(smallest, one.sum.force_layer_frames);
    }
  }
  Json rows = Json::array();
  for (const Contestant& one : all) rows.push_back(row_of("table2", "table2", one.title, one.sum));
  return rows;
}

// Collisions of the paper's model until `contact_frames` are counted; its field as derived where
// `factor`, of the coupling's stiffness, is 0. The paper does not give that stiffness.
Json field_row(double factor, std::uint64_t contact_frames) {
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
  const Interval ratio = interval95(sum.penetration_frames, sum.force_layer_frames);
  std::printf("  %8.0f N/m: %.2g of the contact frames penetrate (95%%: %.2g to %.2g)\n",
              field_n_per_m, sum.penetration_ratio(), ratio.low, ratio.high);
  std::fflush(stdout);
  return {{"factor", factor > 0 ? Json(factor) : Json(nullptr)},
          {"field_n_per_m", field_n_per_m},
          {"trials", sum.trials},
          {"force_layer_frames", sum.force_layer_frames},
          {"penetrating_trials", sum.penetrating_trials},
          {"penetration_ratio", sum.penetration_ratio()},
          {"ratio_95_low", ratio.low},
          {"ratio_95_high", ratio.high}};
}

Json field_table(std::uint64_t contact_frames) {
  Json rows = Json::array();
  for (const double factor : {0.0, 0.5, 1.0, 2.0, 4.0, 8.0}) {
    rows.push_back(field_row(factor, contact_frames));
  }
  return rows;
}

// Whether parts that start installed rest, how deep hands at random push them into the metal about
// them, and whether they come out and go back. Lengths are in voxels.
Json seat_table(std::uint64_t pairs) {
  constexpr double kPushSeconds = 10;
  Json rows = Json::array();
  for (std::uint64_t seed = 0; seed < pairs; ++seed) {
    const InstalledPair pair = installed_pair(seed);
    const SeatOutcome o = try_seat(pair, seed, kPushSeconds, 0);
    std::printf(
        "  %3llu %-20s drift %.3f, depth %.3f, edges %.3f, pushed %.3f, deep %.3f, touching "
        "%.2f%s%s %s\n",
        count(seed), pair.kind, o.drift, o.depth, o.edge_depth, o.pushed_depth, o.deep, o.touching,
        o.came_out ? "" : ", STAYED", o.tried_back && !o.went_back ? ", NOT BACK" : "",
        o.refused.c_str());
    std::fflush(stdout);
    rows.push_back({{"seed", seed},
                    {"covering_voxels", std::sqrt(0.75)},
                    {"pair", pair.kind},
                    {"voxel_m", pair.voxel_size_m},
                    {"gap_m", pair.gap_m},
                    {"refused", o.refused.empty() ? 0 : 1},
                    {"start_depth_voxels", o.start_depth},
                    {"drift_voxels", o.drift},
                    {"still_force_n", o.still_force_n},
                    {"depth_voxels", o.depth},
                    {"edge_depth_voxels", o.edge_depth},
                    {"pushed_depth_voxels", o.pushed_depth},
                    {"deep", o.deep},
                    {"touching", o.touching},
                    {"came_out", o.came_out ? 1 : 0},
                    {"tried_back", o.tried_back ? 1 : 0},
                    {"went_back", o.went_back ? 1 : 0}});
  }
  return rows;
}

// Free flight far from everything: what the step's arithmetic loses. The paper's model flies a
// round body, as its equations have it.
Json drift_row(Model model, std::uint64_t frames) {
  constexpr double kNothing = 1e-30, kDtS = 1e-3;  // a coupling that does nothing
  test::PointPart part;
  part.add({0, 0, -0.02}, {0, 0, 1});
  part.inertia_m2 = model == Model::kDefault
                        ? std::array<double, 6>{0.8e-4, 1.4e-4, 2e-4, 0, 0, 0}
                        : std::array<double, 6>{1.6e-4, 1.6e-4, 1.6e-4, 0, 0, 0};
  test::BenchOptions options;
  options.model = model;
  options.braking = false;
  options.beyond = {{"coupling_n_per_m", kNothing},
                    {"coupling_ns_per_m", kNothing},
                    {"coupling_nm_per_rad", kNothing},
                    {"coupling_nms_per_rad", kNothing}};
  const test::VoxelScene floor =
      test::shape_scene(0.005, {-8, -8, -3}, {16, 16, 14}, [](const glm::dvec3& p) { return p.z; });
  test::MotionBench bench(floor, part, {{0.001, 0.002, 0.5}, {1, 0, 0, 0}}, options);
  bench.state.velocity = {{1e-4, 2e-5, 1e-5}, {3, 10, 1}};
  const glm::dmat3 inertia = bench.parameters().inertia_kgm2;
  const model::RigidMass mass{bench.parameters().mass_kg, inertia, glm::inverse(inertia)};
  const auto momentum = [&] {
    return model::turned(inertia, bench.part().orientation) * bench.state.velocity.angular_radps;
  };
  const auto energy_j = [&] {
    return model::kinetic_energy_j(mass, bench.part().orientation, bench.state.velocity);
  };
  const glm::dvec3 momentum_before = momentum(), from_m = bench.part().position_m,
                   speed_mps = bench.state.velocity.linear_mps;
  const double energy_before = energy_j();
  for (std::uint64_t frame = 0; frame < frames; ++frame) bench.hold();
  const double momentum_off =
      glm::length(momentum() - momentum_before) / glm::length(momentum_before);
  const double energy_off = energy_j() / energy_before - 1;
  const double place_m = glm::length(bench.part().position_m - from_m -
                                     speed_mps * (kDtS * static_cast<double>(frames)));
  std::printf("  %-8s %llu frames: momentum %.1e, energy %.1e, relative; place %.1e m\n",
              name_of(model), count(frames), momentum_off, energy_off, place_m);
  return {{"model", name_of(model)},
          {"frames", frames},
          {"momentum_relative", momentum_off},
          {"energy_relative", energy_off},
          {"place_m", place_m}};
}

Json drift_table(std::uint64_t frames) {
  Json rows = Json::array();
  for (const Model model : kBothModels) rows.push_back(drift_row(model, frames));
  return rows;
}

struct Table {
  const char* name;
  const char* file;  // of results
  std::uint64_t amount;
  std::function<Json(std::uint64_t)> rows;
};

int run_table(int argc, char** argv) {
  const Table tables[] = {
      {"cases", "stability", 3, case_table},
      {"rest", "stability", 500, rest_table},
      {"table2", "stability", 1'000'000, table2},
      {"field", "stability_field", 1'000'000, field_table},
      {"seats", "stability_seats", 203, seat_table},
      {"grips", "stability_grips", 0, [](std::uint64_t) { return grip_table(); }},
      {"step", "stability_step", 100'000, step_table},
      {"drift", "motion_drift", 10'000'000, drift_table}};
  CLI::App app{"Stability of both models side by side", "stability_bench"};
  std::string json;
  std::uint64_t amount = 0;
  std::vector<std::string> names;
  for (const Table& table : tables) names.emplace_back(table.name);
  std::string name;
  app.add_option("table", name, "cases, rest, table2, field, seats, grips, step or drift")
      ->required()
      ->check(CLI::IsMember(names));
  app.add_option("amount", amount, "trials, frames, pairs or steps");
  app.add_option("--json", json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);
  const Table& table = *std::ranges::find(tables, name, &Table::name);
  bench::write_report(table.file, argc, argv, table.rows(amount > 0 ? amount : table.amount), json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::stress

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("stability_bench", forcelayer::stress::run_table, argc,
                                          argv);
}

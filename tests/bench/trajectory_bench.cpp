// How far a part in contact goes astray because of the step: press, slide and peg in a hole, beside
// the same model at a step of a microsecond, over rate, stiffness and voxel size.
//
//   trajectory_bench [--seeds N] [--motion NAME]... [--nominal] [--json FILE]
//
// The parameters are those that are derived at 1 kHz, at all rates, so that the rate alone differs.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>

#include "runtime/coupling/coupling.h"
#include "runtime/loop/handle_velocity.h"
#include "tests/bench/bench_report.h"
#include "tests/stress/cases.h"

namespace forcelayer::stress {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kS = 0.005;          // voxel size of the trials, m
constexpr double kReferenceHz = 1e6;  // a thousandth of the usual step
constexpr double kMarkS = 0.004;      // times at which trajectories are compared
constexpr double kRates[] = {250, 500, 1000, 2000, 4000};

struct Motion {
  const char* name;
  double end_s;  // long enough to touch, press and go on
  bool any_voxel_size;
  Trial (*make)(std::uint64_t seed);
};
// The slide is so deep that it touches with finer voxels too; the hole is as wide as layers of 5 mm
// ask for, and finer ones would leave the peg alone.
constexpr Motion kMotions[] = {
    {"press", 1.2, true, [](std::uint64_t seed) { return press_trial(seed, kS); }},
    {"slide", 1.6, true, [](std::uint64_t seed) { return slide_trial(seed, 3); }},
    {"peg in hole", 3.0, false, [](std::uint64_t seed) { return peg_trial(seed, 0.25); }}};

struct Setting {
  Model model = Model::kDefault;
  double stiffness_factor = 1;  // of coupling and field; dampers stay critical
  double voxel_size_m = kS;
};

// The trial's scene and part at another voxel size.
void rebake(Trial& trial, double voxel_size_m) {
  if (voxel_size_m == kS) return;
  trial.scene = std::make_shared<BakedScene>(trial.scene->mesh(), voxel_size_m);
  trial.part = std::make_shared<BakedPart>(trial.part->mesh(), voxel_size_m);
}

// The parameters that the model derives at 1 kHz, as settings.
void fix_parameters(Trial& trial, const Setting& setting) {
  const Parameters p = make_simulation(trial, setting.model)->parameters();
  const double f = setting.stiffness_factor;
  trial.settings = {{"coupling_n_per_m", f * p.coupling_n_per_m},
                    {"coupling_ns_per_m", std::sqrt(f) * p.coupling_ns_per_m},
                    {"coupling_nm_per_rad", f * p.coupling_nm_per_rad},
                    {"coupling_nms_per_rad", std::sqrt(f) * p.coupling_nms_per_rad},
                    {"coupling_force_limit_n", p.coupling_force_limit_n},
                    {"field_n_per_m", f * p.field_n_per_m},
                    {"mass_kg", p.mass_kg}};
  if (setting.model == Model::kDefault) {
    trial.settings["coupling_torque_limit_nm"] = p.coupling_torque_limit_nm;
    trial.settings["allowance_j"] = p.allowance_j;
  }
}

// Where the part is at every mark.
struct Trajectory {
  std::vector<Pose> poses;
  std::uint64_t contact_frames = 0;
};

Trajectory run(Trial trial, Model model, double rate_hz, double end_s) {
  trial.rate_hz = std::min(rate_hz, kRatesHz.most);  // beyond, the step is dt_s alone
  const auto simulation = make_simulation(trial, model);
  State state = simulation->registered(trial.start, trial.start);
  loop::HandleVelocity velocity;
  StepInput input;
  input.valid = 1;
  const double dt_s = 1 / rate_hz;
  const auto frames = static_cast<std::uint64_t>(std::llround(end_s * rate_hz));
  const auto frames_a_mark = static_cast<std::uint64_t>(std::llround(kMarkS * rate_hz));
  Trajectory trajectory;
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    input.world_from_handle = trial.target(static_cast<double>(frame) * dt_s);
    input.handle_velocity = velocity.update(input.world_from_handle, dt_s);
    trajectory.contact_frames += simulation->step(state, input, dt_s).report.contacts > 0;
    if ((frame + 1) % frames_a_mark == 0) trajectory.poses.push_back(state.world_from_center);
  }
  return trajectory;
}

// How far any point of the part may be from where it should be.
double apart_m(const Pose& a, const Pose& b, double radius_m) {
  return glm::length(a.position_m - b.position_m) +
         radius_m *
             glm::length(coupling::rotation_vector(a.orientation * glm::conjugate(b.orientation)));
}

struct Error {
  double rms_m, most_m;
};

Error error_of(const Trajectory& trajectory, const Trajectory& reference, double radius_m) {
  double squares = 0, most = 0;
  const std::size_t marks = std::min(trajectory.poses.size(), reference.poses.size());
  for (std::size_t i = 0; i < marks; ++i) {
    const double d = apart_m(trajectory.poses[i], reference.poses[i], radius_m);
    squares += d * d, most = std::max(most, d);
  }
  return {std::sqrt(squares / static_cast<double>(marks)), most};
}

double median(std::vector<double> values) { return bench::percentiles(std::move(values)).p50; }

constexpr double kLeastContact = 0.1;  // of the time, at 1 kHz, or a trial says nothing of contact

bool touches(const Motion& motion, std::uint64_t seed) {
  Trial trial = motion.make(seed);
  trial.braking = false;
  const Trajectory usual = run(trial, Model::kDefault, 1000, motion.end_s);
  return static_cast<double>(usual.contact_frames) > kLeastContact * 1000 * motion.end_s;
}

// The first so many seeds whose trials are of contact.
std::vector<std::uint64_t> seeds_of(const Motion& motion, std::uint64_t count) {
  std::vector<std::uint64_t> seeds;
  for (std::uint64_t seed = 1; seeds.size() < count; ++seed) {
    if (touches(motion, seed)) seeds.push_back(seed);
  }
  return seeds;
}

Json row_of(const Motion& motion, const Setting& setting, const std::vector<std::uint64_t>& seeds) {
  std::vector<double> rms[std::size(kRates)], most[std::size(kRates)], touching;
  for (const std::uint64_t seed : seeds) {
    Trial trial = motion.make(seed);
    trial.braking = false;  // the paper's divides by the step: at another rate it is another model
    rebake(trial, setting.voxel_size_m);
    fix_parameters(trial, setting);
    const double radius_m = trial.part->open().header().bounding_radius_m;
    const Trajectory reference = run(trial, setting.model, kReferenceHz, motion.end_s);
    touching.push_back(static_cast<double>(reference.contact_frames) /
                       (kReferenceHz * motion.end_s));
    for (std::size_t r = 0; r < std::size(kRates); ++r) {
      const Error error =
          error_of(run(trial, setting.model, kRates[r], motion.end_s), reference, radius_m);
      rms[r].push_back(error.rms_m), most[r].push_back(error.most_m);
    }
  }
  Json errors = Json::array(), largest = Json::array();
  std::printf("%-12s %-8s k x %-5g %5g mm  contact %3.0f%% ", motion.name,
              setting.model == Model::kPaper ? "paper" : "default", setting.stiffness_factor,
              1e3 * setting.voxel_size_m, 100 * median(touching));
  for (std::size_t r = 0; r < std::size(kRates); ++r) {
    errors.push_back(median(rms[r])), largest.push_back(median(most[r]));
    std::printf(" %8.4f", 1e3 * median(rms[r]));
  }
  std::printf("\n");
  std::fflush(stdout);
  return {{"motion", motion.name},
          {"model", setting.model == Model::kPaper ? "paper" : "default"},
          {"stiffness_factor", setting.stiffness_factor},
          {"voxel_size_m", setting.voxel_size_m},
          {"seeds", seeds},
          {"contact_share", median(touching)},
          {"rates_hz", kRates},
          {"error_m", errors},
          {"largest_m", largest}};
}

int run_bench(int argc, char** argv) {
  CLI::App app{"Trajectory error of contact over the step", "trajectory_bench"};
  std::uint64_t seeds = 3;
  bool nominal = false;
  std::vector<std::string> only;
  std::string json;
  app.add_option("--seeds", seeds, "trials of each motion")->check(CLI::PositiveNumber);
  app.add_option("--motion", only, "press, slide, \"peg in hole\" (default: all)");
  app.add_flag("--nominal", nominal, "one stiffness and voxel size");
  app.add_option("--json", json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);

  std::vector<Setting> settings = {{}, {Model::kPaper}};
  if (!nominal) {
    for (const double factor : {0.25, 4.0}) settings.push_back({Model::kDefault, factor});
    for (const double s : {0.0025, 0.00125}) settings.push_back({Model::kDefault, 1, s});
  }
  std::printf("RMS error, mm, at 250, 500, 1000, 2000 and 4000 Hz beside 1 MHz\n");
  Json rows = Json::array();
  for (const Motion& motion : kMotions) {
    if (!only.empty() && std::find(only.begin(), only.end(), motion.name) == only.end()) continue;
    const std::vector<std::uint64_t> trials = seeds_of(motion, seeds);
    for (const Setting& setting : settings) {
      if (setting.voxel_size_m != kS && !motion.any_voxel_size) continue;
      rows.push_back(row_of(motion, setting, trials));
    }
  }
  bench::write_report("trajectory", argc, argv, rows, json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::stress

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("trajectory_bench", forcelayer::stress::run_bench, argc,
                                          argv);
}

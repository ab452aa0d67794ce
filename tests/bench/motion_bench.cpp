// How truly the models move a body: against closed forms, or against themselves at a thousandth of
// the step.
//   motion_bench [--only EXPERIMENT] [--json FILE]
//
// EXPERIMENT is the name of a row, or "drift".
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <optional>
#include <string>

#include "runtime/model/rigid_body.h"
#include "tests/bench/bench_report.h"
#include "tests/support/distance_scene.h"
#include "tests/support/motion_bench.h"

namespace forcelayer::test {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kS = 0.005;          // voxel size, m
constexpr double kNothing = 1e-30;    // a coupling that does nothing
constexpr double kFieldNPerM = 1000;  // of the bounce: in contact for some 11 ms
constexpr Model kModels[] = {Model::kPaper, Model::kDefault};

const char* name_of(Model model) { return model == Model::kPaper ? "paper" : "default"; }

constexpr double kFloorM = 0.3 * kS;  // height of the surface

// The floor as each model has it: with distances for `default`, in Chebyshev layers for `paper`.
VoxelScene floor_scene(Model model) {
  const Voxel min{-8, -8, -3}, dims{16, 16, 14};
  const auto distance_m = [](const glm::dvec3& p) { return p.z - kFloorM; };
  if (model == Model::kPaper) return shape_scene(kS, min, dims, distance_m);
  return distance_scene(kS, min, dims, distance_m, 2, DistanceDefinition(2));
}

// Where it begins to push.
double push_height_m(Model model) {
  if (model == Model::kPaper) return 2.5 * kS;
  return kFloorM + DistanceDefinition(2).zero_force * kS;
}

// One point at the lowest end of a body of some inertia.
PointPart body(const std::array<double, 6>& inertia_m2) {
  PointPart part;
  part.add({0, 0, -0.02}, {0, 0, 1});
  part.inertia_m2 = inertia_m2;
  return part;
}

constexpr std::array<double, 6> kRound{1.6e-4, 1.6e-4, 1.6e-4, 0, 0, 0};
constexpr std::array<double, 6> kAsymmetric{0.8e-4, 1.4e-4, 2e-4, 0, 0, 0};

struct Setting {
  Model model;
  double step_s;
  double stiffness_n_per_m = kNothing, damping_ns_per_m = kNothing;
  std::array<double, 6> inertia_m2 = kRound;
};

MotionBench bench_of(const Setting& setting, const Pose& start) {
  BenchOptions options;
  options.model = setting.model;
  options.rate_hz =
      std::min(1 / setting.step_s, kRatesHz.most);  // settings have what follows from it
  options.braking = false;
  options.settings = {
      {"coupling_force_limit_n", 100}, {"field_n_per_m", kFieldNPerM}, {"look_ups", 64}};
  options.beyond = {{"coupling_n_per_m", setting.stiffness_n_per_m},
                    {"coupling_ns_per_m", setting.damping_ns_per_m},
                    {"coupling_nm_per_rad", kNothing},
                    {"coupling_nms_per_rad", kNothing}};
  MotionBench bench(floor_scene(setting.model), body(setting.inertia_m2), start, options);
  bench.dt_s = setting.step_s;
  return bench;
}

constexpr Pose kHigh{{0.001, 0.002, 0.5}, {1, 0, 0, 0}};

// Steps until `end_s`; the paper's step samples before it moves, so its state is read after it.
void run_until(MotionBench& bench, double end_s) {
  const auto frames = static_cast<std::uint64_t>(std::llround(end_s / bench.dt_s));
  for (std::uint64_t frame = 0; frame < frames; ++frame) bench.hold();
}

double angle_between(const glm::dquat& a, const glm::dquat& b) {
  return glm::length(coupling::rotation_vector(a * glm::conjugate(b)));
}

// Straight on, turning about one axis. m after 1 s at 0.37 m/s; rad at 2 rad/s of a round body.
double free_flight_error(Model model, double step_s) {
  MotionBench bench = bench_of({model, step_s}, kHigh);
  const Twist start{{0.3, 0.2, 0.1}, {0, 0, 2}};
  bench.state.velocity = start;
  run_until(bench, 1);
  const double way_m = glm::length(bench.part().position_m - kHigh.position_m - start.linear_mps);
  return std::max(way_m, 0.02 * angle_between(bench.part().orientation,
                                              coupling::rotation_by(start.angular_radps)));
}

// A body on the coupling's spring alone, 5 mm from rest, after 0.256 s, or critically damped after
// 32 ms; m.
double pendulum_error(Model model, double step_s, bool damped) {
  constexpr double kStiffness = 100, kMass = 0.012, kStretch = 0.005, kEnd = 0.256;
  const double w = std::sqrt(kStiffness / kMass);
  MotionBench bench = bench_of(
      {model, step_s, kStiffness, damped ? 2 * std::sqrt(kStiffness * kMass) : kNothing}, kHigh);
  bench.state.world_from_center.position_m.x += kStretch;
  run_until(bench, damped ? kEnd / 8 : kEnd);
  const double t = damped ? kEnd / 8 : kEnd;
  const double truth = kStretch * (damped ? (1 + w * t) * std::exp(-w * t) : std::cos(w * t));
  return std::abs(bench.part().position_m.x - kHigh.position_m.x - truth);
}

// Where a run of 0.5 s ends, and how far another ends from it.
Pose spin_end(double step_s) {
  MotionBench bench = bench_of({Model::kDefault, step_s, kNothing, kNothing, kAsymmetric}, kHigh);
  bench.state.velocity.angular_radps = {3, 10, 1};
  run_until(bench, 0.5);
  return bench.part();
}

// Thrown at the floor at 0.1 m/s, 4 mm above where it pushes, and back up. m after 0.12 s.
Pose bounce_end(Model model, double step_s) {
  MotionBench bench = bench_of({model, step_s},
                               {{0.001, 0.002, 0.02 + push_height_m(model) + 0.004}, {1, 0, 0, 0}});
  bench.state.velocity.linear_mps = {0, 0, -0.1};
  run_until(bench, 0.12);
  return bench.part();
}

// Slope of log error over log step, at the four finest steps: coarser ones may not resolve the
// motion.
double order_of(const std::vector<double>& steps, const std::vector<double>& errors) {
  constexpr std::size_t kFinest = 4;
  double sx = 0, sy = 0, sxx = 0, sxy = 0;
  const double n = kFinest;
  for (std::size_t i = steps.size() - kFinest; i < steps.size(); ++i) {
    const double x = std::log(steps[i]), y = std::log(errors[i]);
    sx += x, sy += y, sxx += x * x, sxy += x * y;
  }
  return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

Json row(const char* what, Model model, const std::vector<double>& steps_s, double exact_below,
         const std::function<double(double)>& error_of) {
  std::vector<double> errors;
  for (const double step_s : steps_s) errors.push_back(error_of(step_s));
  const bool exact = *std::max_element(errors.begin(), errors.end()) < exact_below;
  const double order = exact ? 0 : order_of(steps_s, errors);
  std::printf("  %-22s %-8s", what, name_of(model));
  for (const double error : errors) std::printf(" %9.2g", error);
  std::printf(exact ? "   exact\n" : "   order %.2f\n", order);
  std::fflush(stdout);
  return {{"step_s", steps_s},
          {"error", errors},
          {"order", exact ? Json(nullptr) : Json(order)},
          {"exact_below", exact_below}};
}

// Free flight of an asymmetric body for ten million frames: what the step's arithmetic loses.
Json drift(Model model) {
  constexpr std::uint64_t kFrames = 10'000'000;
  const bool own = model == Model::kDefault;
  MotionBench bench =
      bench_of({model, 0.001, kNothing, kNothing, own ? kAsymmetric : kRound}, kHigh);
  bench.state.velocity = {{1e-4, 2e-5, 1e-5}, {3, 10, 1}};
  const glm::dmat3 inertia = bench.parameters().inertia_kgm2;
  const model::RigidMass mass{bench.parameters().mass_kg, inertia, glm::inverse(inertia)};
  const auto momentum = [&] {
    return model::turned(inertia, bench.part().orientation) * bench.state.velocity.angular_radps;
  };
  const auto energy_j = [&] {
    return model::kinetic_energy_j(mass, bench.part().orientation, bench.state.velocity);
  };
  const glm::dvec3 momentum_before = momentum(), way_before = bench.part().position_m,
                   speed_mps = bench.state.velocity.linear_mps;
  const double energy_before = energy_j();
  double swing = 0;
  for (std::uint64_t frame = 0; frame < kFrames; ++frame) {
    bench.hold();
    if (frame % 997 == 0) swing = std::max(swing, std::abs(energy_j() / energy_before - 1));
  }
  const double momentum_drift =
      glm::length(momentum() - momentum_before) / glm::length(momentum_before);
  const double energy_drift = energy_j() / energy_before - 1;
  const double way_drift = glm::length(bench.part().position_m - way_before -
                                       speed_mps * (1e-3 * static_cast<double>(kFrames)));
  std::printf(
      "  %-8s 1e7 frames: momentum %.1e, energy %.1e (swing %.1e) relative; place %.1e m of %.1f\n",
      name_of(model), momentum_drift, energy_drift, swing, way_drift, glm::length(speed_mps) * 1e4);
  std::fflush(stdout);
  return {{"frames", kFrames},
          {"momentum_relative", momentum_drift},
          {"energy_relative", energy_drift},
          {"energy_swing_relative", swing},
          {"place_m", way_drift}};
}

Json measured(const std::string& only) {
  const auto wanted = [&](const char* what) { return only.empty() || only == what; };
  const std::vector<double> steps{4e-3, 2e-3, 1e-3, 5e-4, 2.5e-4, 1.25e-4};
  Json report;
  std::printf("error (m; spin: rad) at steps of 4, 2, 1, 0.5, 0.25, 0.125 ms\n");
  for (const Model model : kModels) {
    const auto add = [&](const char* what, double exact_below, auto&& error_of) {
      if (wanted(what)) {
        report[what][name_of(model)] = row(what, model, steps, exact_below, error_of);
      }
    };
    add("free flight", 1e-10, [&](double h) { return free_flight_error(model, h); });
    add("pendulum", 0, [&](double h) { return pendulum_error(model, h, false); });
    add("pendulum, critical", 0, [&](double h) { return pendulum_error(model, h, true); });
    std::optional<Pose> landed;
    add("bounce", 0, [&](double h) {
      if (!landed) landed = bounce_end(model, 1.25e-7);
      return glm::length(bounce_end(model, h).position_m - landed->position_m);
    });
  }
  if (wanted("asymmetric spin")) {
    const glm::dquat truth = spin_end(1.25e-7).orientation;
    report["asymmetric spin"]["default"] =
        row("asymmetric spin", Model::kDefault, steps, 0,
            [&](double h) { return angle_between(spin_end(h).orientation, truth); });
  }
  if (wanted("drift")) {
    for (const Model model : kModels) report["drift"][name_of(model)] = drift(model);
  }
  return report;
}

int run(int argc, char** argv) {
  CLI::App app{"Motion against closed forms and against itself", "motion_bench"};
  std::string only, json;
  app.add_option("--only", only, "\"bounce\", \"pendulum\", ... (default: all)");
  app.add_option("--json", json, "where to write the figures");
  CLI11_PARSE(app, argc, argv);
  bench::write_report("motion", argc, argv, measured(only), json);
  return 0;
}

}  // namespace
}  // namespace forcelayer::test

int main(int argc, char** argv) {
  return forcelayer::bench::run_benchmark("motion_bench", forcelayer::test::run, argc, argv);
}

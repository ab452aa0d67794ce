// The time of a step of the default model beyond its contact queries.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "runtime/field/force_field.h"
#include "runtime/guard/pose_guard.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/model/default_model.h"
#include "runtime/model/simulation.h"
#include "tests/bench/bench_report.h"
#include "tests/bench/stability_bench.h"
#include "tests/stress/shapes.h"

namespace forcelayer::stress {
namespace {

constexpr double kS = 0.005, kDtS = 0.001;

double us_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin)
      .count();
}

// Times the two halves of the look-ups of a step.
class TimedProbe final : public field::ContactProbe {
 public:
  TimedProbe(guard::PoseGuard& probe, query::ContactQuery& query, query::CollectedPoints& points)
      : probe_(probe), query_(query), points_(points) {}

  void query_pose(const Pose& pose, field::ContactSet& out) noexcept override {
    ++look_ups;
    const auto begin = std::chrono::steady_clock::now();
    query_.run(pose, points_);
    const double one_us = us_since(begin);
    probe_.measure_and_judge(out);
    query_us += one_us;
    field_us += us_since(begin) - one_us;
  }

  void reset() { query_us = field_us = 0, look_ups = 0; }

  double query_us = 0;
  double field_us = 0;  // of the rest of the look-ups
  int look_ups = 0;

 private:
  guard::PoseGuard& probe_;
  query::ContactQuery& query_;
  query::CollectedPoints& points_;
};

// Work that takes the same number of instructions every time and touches no memory: what its
// percentiles rise above its median is the machine's doing, not that of the code measured beside
// it.
class ControlLoop {
 public:
  // As many turns as take about \p about_us.
  explicit ControlLoop(double about_us) {
    for (double took_us = 0; took_us < about_us; turns_ *= 2) {
      took_us = 1e300;
      for (int i = 0; i < 100; ++i) took_us = std::min(took_us, run_us());
      if (took_us * 2 > about_us) {
        turns_ = static_cast<std::uint64_t>(static_cast<double>(turns_) * about_us / took_us);
        break;
      }
    }
  }

  double run_us() {
    const auto begin = std::chrono::steady_clock::now();
    for (std::uint64_t i = 0; i < turns_; ++i) state_ = state_ * 6364136223846793005u + 1;
    last_ = state_;
    return us_since(begin);
  }

 private:
  std::uint64_t turns_ = 1000, state_ = 1;
  volatile std::uint64_t last_ = 0;  // so that the loop is run
};

}  // namespace

// A plate that lies flat on a floor and slides: two hundred points and more touch.
Json step_cost(std::uint64_t steps) {
  Trial trial;
  trial.scene = std::make_shared<BakedScene>(box(glm::dvec3(40, 40, 4) * kS), kS);
  trial.part = std::make_shared<BakedPart>(box(glm::dvec3(9, 9, 2) * kS), kS);
  const auto simulation = make_simulation(trial, Model::kDefault);
  const Pshell& shell = simulation->shell();
  query::ContactQuery query(simulation->voxmap(), shell, {});
  const auto field = field::make_force_field(Model::kDefault, simulation->parameters().force,
                                             simulation->voxmap());
  if (!field) throw std::runtime_error(to_line(field.error()));
  query::CollectedPoints points;
  field::FieldSamples samples;
  points.reserve(shell.view().point_count);
  samples.reserve(shell.view().point_count);
  guard::PoseGuard probe(query, **field, points, samples);
  TimedProbe timed(probe, query, points);
  model::DefaultModel model(simulation->parameters(), timed, shell.view().point_count,
                            field::ForceCurve(simulation->voxmap()));

  const Pose start{{-20 * kS, 0, 16 * kS}, {1, 0, 0, 0}};
  State state = simulation->registered(start, start);
  loop::HandleVelocity velocity;
  StepInput input;
  input.valid = 1;
  ControlLoop control(15);  // what a step takes beyond its query
  std::vector<double> solve_us, field_us, query_us, control_us, contacts, look_ups;
  for (std::uint64_t n = 0; n < steps + 1000; ++n) {
    const double t = static_cast<double>(n) * kDtS;
    const double down = std::min(1.0, t / 0.5) * 14 * kS;
    const double along = 20 * kS * (1 - std::cos(std::max(0.0, t - 1) * 0.6));
    input.world_from_handle.position_m = start.position_m + glm::dvec3(along, 0, -down);
    input.handle_velocity = velocity.update(input.world_from_handle, kDtS);
    timed.reset();
    const auto begin = std::chrono::steady_clock::now();
    const double measuring_us = us_since(begin);  // of the clock itself
    const StepResult result = model.step(state, input, kDtS);
    const double all_us = us_since(begin) - measuring_us;
    // As Simulation does: what the hand saw.
    state.world_from_handle = input.world_from_handle;
    state.handle_velocity = input.handle_velocity;
    state.has_handle = 1;
    const double one_control_us = control.run_us();
    if (t < 1) continue;
    control_us.push_back(one_control_us);
    solve_us.push_back(all_us - timed.field_us - timed.query_us);
    field_us.push_back(timed.field_us);
    query_us.push_back(timed.query_us);
    contacts.push_back(result.report.contacts);
    look_ups.push_back(timed.look_ups);
  }
  Json report{{"steps", solve_us.size()},
              {"points", shell.view().point_count},
              {"contacts_p10", percentile(contacts, 10)},
              {"contacts_p50", percentile(contacts, 50)},
              {"look_ups_p99", percentile(look_ups, 99)}};
  std::printf(
      "%llu steps with %.0f contacts (p50; p10 %.0f), %.0f look-up (p99), us: p50 p99 p99.9\n",
      static_cast<unsigned long long>(solve_us.size()), percentile(contacts, 50),
      percentile(contacts, 10), percentile(look_ups, 99));
  const auto add = [&](const char* what, const std::vector<double>& us) {
    const auto p = bench::percentiles(us);
    std::printf("  %-12s %6.1f %6.1f %6.1f\n", what, p.p50, p.p99, p.p999);
    report[std::string(what) + "_us"] = bench::to_json(p);
  };
  add("query", query_us);
  add("field", field_us);
  add("solve", solve_us);
  std::vector<double> beyond(solve_us);
  for (std::size_t i = 0; i < beyond.size(); ++i) beyond[i] += field_us[i];
  add("beyond_query", beyond);
  add("control", control_us);
  const double machine = percentile(control_us, 99) / percentile(control_us, 50);
  std::printf(
      "  the control loop's 99th percentile is %.2f times its median; without that, beyond the "
      "query: %.1f us\n",
      machine, percentile(beyond, 99) / machine);
  report["control_p99_over_p50"] = machine;
  report["beyond_query_p99_over_control_us"] = percentile(beyond, 99) / machine;
  return report;
}

}  // namespace forcelayer::stress

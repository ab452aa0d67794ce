// The time of a step of the default model: contact query, field and solve.
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
    const auto begin = std::chrono::steady_clock::now();
    query_.run(pose, points_);
    const double one_us = us_since(begin);
    probe_.measure_and_judge(out);
    query_us += one_us;
    field_us += us_since(begin) - one_us;
  }

  void reset() { query_us = field_us = 0; }

  double query_us = 0;
  double field_us = 0;  // of the rest of the look-ups

 private:
  guard::PoseGuard& probe_;
  query::ContactQuery& query_;
  query::CollectedPoints& points_;
};

}  // namespace

// A plate that lies flat on a floor and slides: two hundred points and more touch.
Json step_table(std::uint64_t steps) {
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
  std::vector<double> solve_us, field_us, query_us, contacts;
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
    if (t < 1) continue;
    solve_us.push_back(all_us - timed.field_us - timed.query_us);
    field_us.push_back(timed.field_us);
    query_us.push_back(timed.query_us);
    contacts.push_back(result.report.contacts);
  }
  std::vector<double> beyond_us(solve_us);
  for (std::size_t i = 0; i < beyond_us.size(); ++i) beyond_us[i] += field_us[i];
  Json rows = Json::array();
  const double contacts_p50 = percentile(contacts, 50);
  std::printf("%zu steps with %.0f contacts, us: p50 p99 p99.9\n", solve_us.size(), contacts_p50);
  const auto add = [&](const char* part, const std::vector<double>& us) {
    const auto p = bench::percentiles(us);
    std::printf("  %-12s %6.1f %6.1f %6.1f\n", part, p.p50, p.p99, p.p999);
    rows.push_back({{"part", part},
                    {"contacts", contacts_p50},
                    {"steps", us.size()},
                    {"p50_us", p.p50},
                    {"p99_us", p.p99},
                    {"p999_us", p.p999},
                    {"max_us", p.max}});
  };
  add("query", query_us);
  add("field", field_us);
  add("solve", solve_us);
  add("beyond_query", beyond_us);
  return rows;
}

}  // namespace forcelayer::stress

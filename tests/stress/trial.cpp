#include "tests/stress/trial.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <stdexcept>

#include "runtime/coupling/coupling.h"
#include "runtime/loop/device_port.h"
#include "runtime/loop/handle_velocity.h"
#include "runtime/loop/output_stage.h"
#include "tests/stress/exact_distance.h"

namespace forcelayer::stress {
namespace {

bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// How far any point of a sphere about the center goes between two poses of the center.
double travel_m(const Pose& a, const Pose& b, double radius_m) {
  return glm::length(b.position_m - a.position_m) +
         radius_m *
             glm::length(coupling::rotation_vector(b.orientation * glm::conjugate(a.orientation)));
}

// Peak to peak of a pose about the first one seen: the place, and the angle times a radius.
class Extent {
 public:
  void see(const Pose& pose) {
    if (!first_) first_ = pose;
    const glm::dvec3 way_m = pose.position_m - first_->position_m;
    const glm::dvec3 turn =
        coupling::rotation_vector(pose.orientation * glm::conjugate(first_->orientation));
    low_m_ = glm::min(low_m_, way_m);
    high_m_ = glm::max(high_m_, way_m);
    low_rad_ = glm::min(low_rad_, turn);
    high_rad_ = glm::max(high_rad_, turn);
  }

  double length_m(double radius_m) const {
    if (!first_) return 0;
    return glm::length(high_m_ - low_m_) + radius_m * glm::length(high_rad_ - low_rad_);
  }

 private:
  std::optional<Pose> first_;
  glm::dvec3 low_m_{1e300}, high_m_{-1e300}, low_rad_{1e300}, high_rad_{-1e300};
};

// Watches a part while the handle is held still.
class HoldWatch {
 public:
  HoldWatch(double from_s, double to_s, double radius_m, double voxel_size_m)
      : from_s_(from_s),
        middle_s_((from_s + to_s) / 2),
        to_s_(to_s),
        radius_m_(radius_m),
        s_(voxel_size_m) {}

  void see(double t_s, const Pose& part, const Wrench& wrench) {
    if (t_s < from_s_) return;
    const double way = started_ ? travel_m(last_, part, radius_m_) / s_ : 0;
    const double force_step = started_ ? glm::length(wrench.force_n - last_force_n_) : 0;
    // Rest is what the model promises: less than a millionth of a voxel and of a newton.
    if (way > 1e-6 || force_step > 1e-6) settle_s_ = t_s - from_s_;
    if (t_s >= middle_s_) {
      (t_s < (middle_s_ + to_s_) / 2 ? third_ : last_quarter_).see(part);
      both_.see(part);
      low_n_ = glm::min(low_n_, wrench.force_n);
      high_n_ = glm::max(high_n_, wrench.force_n);
      reported_ = true;
    }
    started_ = true;
    last_ = part;
    last_force_n_ = wrench.force_n;
  }

  void report(Metrics& metrics) const {
    metrics.rest_force_n.push_back(glm::length(last_force_n_));
    metrics.settle_s.push_back(settle_s_);
    metrics.cycle_voxels.push_back(both_.length_m(radius_m_) / s_);
    metrics.swing_third_voxels.push_back(third_.length_m(radius_m_) / s_);
    metrics.swing_last_voxels.push_back(last_quarter_.length_m(radius_m_) / s_);
    metrics.cycle_force_n.push_back(reported_ ? glm::length(high_n_ - low_n_) : 0);
  }

 private:
  double from_s_, middle_s_, to_s_, radius_m_, s_;
  bool started_ = false, reported_ = false;
  Pose last_;
  glm::dvec3 last_force_n_{0}, low_n_{1e300}, high_n_{-1e300};
  Extent third_, last_quarter_, both_;
  double settle_s_ = 0;
};

// Watches a part while the handle slides along a direction.
class SlideWatch {
 public:
  SlideWatch(double from_s, const glm::dvec3& direction) : from_s_(from_s), along_(direction) {}

  void see(double t_s, const Pose& part, const Pose& target) {
    if (t_s < from_s_) return;
    const double x = glm::dot(part.position_m, along_), goal = glm::dot(target.position_m, along_);
    if (frames_ == 0) {
      first_m_ = x;
      first_goal_m_ = goal;
    } else if (x - last_m_ < 0.05 * (goal - last_goal_m_)) {
      ++stuck_;
    }
    ++frames_;
    last_m_ = x;
    last_goal_m_ = goal;
  }

  void report(Metrics& metrics) const {
    if (frames_ < 2) return;
    metrics.progress.push_back((last_m_ - first_m_) / (last_goal_m_ - first_goal_m_));
    metrics.stuck_fraction.push_back(static_cast<double>(stuck_) /
                                     static_cast<double>(frames_ - 1));
  }

 private:
  double from_s_;
  glm::dvec3 along_;
  std::uint64_t frames_ = 0, stuck_ = 0;
  double first_m_ = 0, first_goal_m_ = 0, last_m_ = 0, last_goal_m_ = 0;
};

void count_frame(const StepResult& result, const Parameters& limits, Metrics& metrics) {
  const StepReport& report = result.report;
  ++metrics.frames;
  metrics.force_layer_frames += report.interior + report.surface > 0;
  metrics.penetration_frames += report.interior > 0;
  if (!finite(result.wrench.force_n) || !finite(result.wrench.torque_nm) ||
      !finite(report.world_from_center.position_m)) {
    ++metrics.non_finite;
    return;
  }
  const double force_n = glm::length(result.at_handle.force_n);
  const double torque_nm = glm::length(result.at_handle.torque_nm);
  // Rounding of a clamped length aside.
  metrics.over_limit +=
      force_n > limits.max_force_n * (1 + 1e-9) || torque_nm > limits.max_torque_nm * (1 + 1e-9);
}

// The handle's mover: the trial's script, or a hand that wants to follow it and feels the
// device's output, itself within the device's limits.
class Handle {
 public:
  Handle(const Trial& trial, const Parameters& parameters)
      : trial_(trial), parameters_(parameters), output_(limits_of(parameters)) {
    if (trial.hand) hand_.emplace(*trial.hand, trial.target(0));
  }

  Pose next(double t_s, double dt_s) {
    const Pose wanted = trial_.target(t_s);
    return hand_ ? hand_->step(wanted, felt_, dt_s) : wanted;
  }

  // The step's outcome, and what the passivity controller adds. A handle that the script moves
  // feels no device: its wrench goes through the port as it is.
  void feel(const StepResult& result, const StepInput& input, double dt_s) {
    const StepReport& report = result.report;
    if (report.faults != 0) {
      port_.lose_handle();
    } else {
      port_.arrive(input.world_from_handle,
                   report.interior + report.surface + report.proximity > 0);
    }
    const Wrench damper =
        port_.damping(input.handle_velocity, parameters_.part_radius_m,
                      report.faults == 0 ? parameters_.passivity_damping_ns_per_m : 0, dt_s);
    loop::OutputFrame frame;
    frame.wanted = {result.at_handle.force_n + damper.force_n,
                    result.at_handle.torque_nm + damper.torque_nm};
    frame.unstretched = true;  // armed from the start
    felt_ = hand_ ? output_.pass(frame, dt_s) : frame.wanted;
    port_.leave(felt_);
  }

  double generated_j() const { return port_.generated_j(); }

 private:
  static loop::OutputLimits limits_of(const Parameters& parameters) {
    loop::OutputLimits limits;
    limits.max_force_n = parameters.max_force_n;
    limits.max_torque_nm = parameters.max_torque_nm;
    return limits;
  }

  const Trial& trial_;
  const Parameters& parameters_;
  std::optional<devices::SimHand> hand_;
  loop::OutputStage output_;
  loop::DevicePort port_;
  Wrench felt_;
};

Pose middle_of(const Pose& a, const Pose& b) {
  return {0.5 * (a.position_m + b.position_m),
          glm::normalize(
              coupling::rotation_by(
                  0.5 * coupling::rotation_vector(b.orientation * glm::conjugate(a.orientation))) *
              a.orientation)};
}

}  // namespace

Run open_trial(const Trial& trial, Model model) {
  RunRequest request;
  request.model = model;
  request.rate_hz = trial.rate_hz;
  request.settings = trial.settings;
  request.braking = trial.braking;
  request.device = trial.device;
  request.without_guarantee = true;
  const auto usual = model == Model::kPaper ? test::VoxelKind::kChebyshev : test::VoxelKind::kFull;
  auto run = open_run(trial.scene->open(trial.voxels.value_or(usual)), trial.part->open(), request);
  if (!run) throw std::runtime_error(to_line(run.error()));
  return std::move(*run);
}

std::unique_ptr<model::Simulation> make_simulation(const Trial& trial, Model model) {
  return open_trial(trial, model).release_simulation();
}

DeviceCapabilities trial_device() {
  DeviceCapabilities device;
  device.name = "trial";
  device.max_force_n = 15;
  device.max_torque_nm = 0.1;
  device.damping_ns_per_m = 2;
  device.damping_nms_per_rad = 0.005;
  device.delay_s = 0.001;
  return device;
}

void Metrics::add(const Metrics& other) {
  trials += other.trials;
  frames += other.frames;
  starts_inside += other.starts_inside;
  force_layer_frames += other.force_layer_frames;
  penetration_frames += other.penetration_frames;
  penetrating_trials += other.penetrating_trials;
  non_finite += other.non_finite;
  over_limit += other.over_limit;
  generated_j += other.generated_j;
  distances_visited += other.distances_visited;
  distances_measured += other.distances_measured;
  worst_generated_j = std::max(worst_generated_j, other.worst_generated_j);
  smallest_distance_m = std::min(smallest_distance_m, other.smallest_distance_m);
  guaranteed_m = std::min(guaranteed_m, other.guaranteed_m);
  for (auto member : {&Metrics::rest_force_n, &Metrics::cycle_voxels, &Metrics::cycle_force_n,
                      &Metrics::settle_s, &Metrics::swing_third_voxels, &Metrics::swing_last_voxels,
                      &Metrics::progress, &Metrics::stuck_fraction}) {
    const auto& from = other.*member;
    (this->*member).insert((this->*member).end(), from.begin(), from.end());
  }
}

Metrics run(const Trial& trial, Model model) {
  Run opened = open_trial(trial, model);
  model::Simulation* const simulation = &opened.simulation();
  const PshellHeader& shell = simulation->shell().header();
  const double s = simulation->voxmap().voxel_size_m(), dt_s = 1 / trial.rate_hz;
  const double radius_m = shell.bounding_radius_m + shell.covering_radius_m;
  Metrics metrics;
  metrics.trials = 1;
  metrics.guaranteed_m = opened.guarantee().swept_m.value_or(0);

  std::optional<ExactDistance> exact;
  std::optional<PathDistance> distance;
  if (trial.exact_distance) {
    exact.emplace(trial.scene->mesh(), trial.part->mesh());
    distance.emplace(*exact, radius_m, trial.distance_below_m);
  }
  std::optional<HoldWatch> hold;
  if (trial.hold_from_s) hold.emplace(*trial.hold_from_s, trial.duration_s, radius_m, s);
  std::optional<SlideWatch> slide;
  if (trial.slide_from_s) slide.emplace(*trial.slide_from_s, trial.slide_direction);

  State state = simulation->registered(trial.start, trial.start);
  const glm::dvec3 center_m(shell.center_m[0], shell.center_m[1], shell.center_m[2]);
  Handle handle(trial, simulation->parameters());
  loop::HandleVelocity velocity;
  StepInput input;
  input.valid = 1;
  StepResult last{};
  const auto frames = static_cast<std::uint64_t>(std::llround(trial.duration_s * trial.rate_hz));
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    const double t_s = static_cast<double>(frame) * dt_s;
    const Pose before = frame > 0 ? last.report.world_from_center : state.world_from_center;
    input.world_from_handle = handle.next(t_s, dt_s);
    input.handle_velocity = velocity.update(input.world_from_handle, dt_s);
    StepInput seen = input;
    double passed_s = dt_s;
    if (trial.disturb) trial.disturb(seen, passed_s);
    const StepResult result = simulation->step(state, seen, passed_s);
    if (frame == 0 && result.report.interior > 0) {
      // Not the model's doing: such a trial says nothing of it.
      metrics.starts_inside = 1;
      return metrics;
    }
    count_frame(result, simulation->parameters(), metrics);
    const Pose& part = result.report.world_from_center;
    if (distance && std::isfinite(part.position_m.x)) {
      if (frame > 0 && travel_m(before, part, radius_m) <= s / 2) {
        distance->visit(simulation->world_from_part(middle_of(before, part)), center_m);
      }
      distance->visit(simulation->world_from_part(part), center_m);
    }
    const Pose target = simulation->world_from_center(input.world_from_handle);
    handle.feel(result, seen, dt_s);
    if (hold) hold->see(t_s, part, result.wrench);
    if (slide) slide->see(t_s, part, target);
    last = result;
  }
  metrics.generated_j = metrics.worst_generated_j = handle.generated_j();
  metrics.penetrating_trials = metrics.penetration_frames > 0 ? 1 : 0;
  if (hold) hold->report(metrics);
  if (slide) slide->report(metrics);
  if (distance) {
    metrics.smallest_distance_m = distance->smallest_m();
    metrics.distances_visited = distance->visited();
    metrics.distances_measured = distance->measured();
  }
  return metrics;
}

double percentile(std::vector<double> sample, double p) {
  if (sample.empty()) return 0;
  const auto rank = static_cast<std::size_t>(
      std::clamp(std::ceil(p / 100 * static_cast<double>(sample.size())) - 1, 0.0,
                 static_cast<double>(sample.size() - 1)));
  std::nth_element(sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(rank),
                   sample.end());
  return sample[rank];
}

namespace {

// P(X <= k) of a binomial with n trials, by the sum of its terms in logarithms.
double binomial_cdf(std::uint64_t k, std::uint64_t n, double p) {
  double sum = 0;
  for (std::uint64_t i = 0; i <= k; ++i) {
    const double x = static_cast<double>(i), m = static_cast<double>(n);
    sum += std::exp(std::lgamma(m + 1) - std::lgamma(x + 1) - std::lgamma(m - x + 1) +
                    x * std::log(p) + (m - x) * std::log1p(-p));
  }
  return std::min(1.0, sum);
}

template <typename Above>
double bisected(Above&& above) {
  double low = 1e-12, high = 1 - 1e-12;
  for (int i = 0; i < 100; ++i) {
    const double middle = std::sqrt(low * high);
    (above(middle) ? high : low) = middle;
  }
  return std::sqrt(low * high);
}

}  // namespace

Interval interval95(std::uint64_t events, std::uint64_t frames) {
  if (frames == 0) return {0, 1};
  if (events == 0) return {0, std::min(1.0, 3.0 / static_cast<double>(frames))};
  if (events > 100000) {  // the normal approximation is exact to all digits that matter
    const double n = static_cast<double>(frames), p = static_cast<double>(events) / n;
    const double half = 1.96 * std::sqrt(p * (1 - p) / n);
    return {p - half, std::min(1.0, p + half)};
  }
  const double low =
      bisected([&](double p) { return 1 - binomial_cdf(events - 1, frames, p) > 0.025; });
  const double high = events == frames ? 1 : bisected([&](double p) {
    return binomial_cdf(events, frames, p) < 0.025;
  });
  return {low, high};
}

}  // namespace forcelayer::stress
